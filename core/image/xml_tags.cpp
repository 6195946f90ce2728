#include "core/image/xml_tags.h"

#include <algorithm>
#include <array>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "core/image/image_refusal.h"

namespace tet {
namespace {

constexpr std::size_t kMostAttributes = 32;

bool is_name(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' ||
         c == ':' || c == '.';
}

std::string unescaped(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] != '&') {
      out += text[i++];
      continue;
    }
    const auto* known = std::ranges::find_if(kEntities, [&](const auto& entity) {
      return text.substr(i).starts_with(entity.first);
    });
    if (known == kEntities.end()) {
      refuse_image(absl::StrCat("its XML has the entity ", quoted_text(text.substr(i, 12))));
    }
    out += known->second;
    i += known->first.size();
  }
  return out;
}

/// Reads a tag whose text is between its brackets.
class TagReader {
 public:
  explicit TagReader(std::string_view text) : text_(text) {}

  void read(XmlTag& tag) {
    if (take('/')) tag.closes = true;
    tag.name = name();
    if (tag.name.empty()) fail();
    skip_blanks();
    while (at_ < text_.size() && text_[at_] != '/') {
      if (tag.attributes.size() == kMostAttributes) fail();
      const std::string_view key = name();
      skip_blanks();
      if (key.empty() || !take('=')) fail();
      skip_blanks();
      tag.attributes.emplace_back(key, unescaped(quoted()));
      skip_blanks();
    }
    tag.closes_itself = take('/');
    if (at_ != text_.size() || (tag.closes && tag.closes_itself)) fail();
  }

 private:
  [[noreturn]] void fail() const {
    refuse_image(absl::StrCat("its XML has the tag ", quoted_text(text_)));
  }
  bool take(char c) {
    const bool there = at_ < text_.size() && text_[at_] == c;
    if (there) ++at_;
    return there;
  }
  void skip_blanks() {
    while (at_ < text_.size() && absl::ascii_isspace(static_cast<unsigned char>(text_[at_]))) {
      ++at_;
    }
  }
  std::string_view name() {
    const std::size_t from = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    return text_.substr(from, at_ - from);
  }
  std::string_view quoted() {
    if (at_ == text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) fail();
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string_view::npos) fail();
    const std::string_view value = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// The '>' that ends a tag: not one in quotes.
std::size_t end_of_tag(std::string_view text, std::size_t at) {
  char quote = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at;
    }
  }
  return std::string_view::npos;
}

}  // namespace

const std::string* XmlTag::find(std::string_view wanted) const noexcept {
  for (const auto& [key, value] : attributes) {
    if (key == wanted) return &value;
  }
  return nullptr;
}

std::optional<XmlTag> next_tag(std::string_view text, std::size_t at) {
  while (true) {
    const std::size_t begin = text.find('<', at);
    if (begin == std::string_view::npos) return std::nullopt;
    if (text.substr(begin).starts_with("<!--")) {
      const std::size_t end = text.find("-->", begin);
      if (end == std::string_view::npos) return std::nullopt;
      at = end + 3;
      continue;
    }
    if (text.substr(begin).starts_with("<!")) refuse_image("its XML has a DTD, or CDATA");
    const std::size_t end = end_of_tag(text, begin);
    if (end == std::string_view::npos) return std::nullopt;
    if (text.substr(begin).starts_with("<?")) {
      at = end + 1;
      continue;
    }
    XmlTag tag;
    tag.begin = begin;
    tag.end = end + 1;
    TagReader(text.substr(begin + 1, end - begin - 1)).read(tag);
    return tag;
  }
}

}  // namespace tet
