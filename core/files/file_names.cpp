#include "core/files/file_names.h"

#include <array>
#include <set>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

namespace tet {
namespace {

/// Whether a byte of UTF-8 goes on with a character that began before it.
bool goes_on(char byte) noexcept { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

/// The first bytes of a name, no more than that, and whole characters.
std::string cut(const std::string& name, std::size_t most_bytes) {
  if (name.size() <= most_bytes) return name;
  std::size_t end = most_bytes;
  while (end > 0 && goes_on(name[end])) --end;
  return name.substr(0, end);
}

std::string with_good_characters(const std::string& name, const NameRule& rule) {
  std::string good;
  for (const char c : name) {
    if (!rule.bad_characters.empty()) {
      good += rule.bad_characters.find(c) == std::string_view::npos ? c : rule.in_their_place;
    } else if (absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_') {
      good += c;
    } else if (!goes_on(c)) {
      good += '_';  // one for a character, whatever bytes it has
    }
  }
  const bool has_start =
      !good.empty() && absl::ascii_isalpha(static_cast<unsigned char>(good[0]));
  if (good.empty() || (rule.letter_first && !has_start)) good.insert(good.begin(), 'n');
  return cut(good, rule.most_bytes);
}

/// Names that no other may have.
class TakenNames {
 public:
  explicit TakenNames(const NameRule& rule)
      : rule_(rule), taken_(rule.taken.begin(), rule.taken.end()) {}

  /// Takes the name with each of these endings, unless one of those is taken.
  bool take(const std::string& name, std::span<const std::string_view> endings) {
    const auto key = [&](std::string_view ending) {
      const std::string whole = name + std::string(ending);
      return rule_.ignores_case ? absl::AsciiStrToLower(whole) : whole;
    };
    for (const std::string_view ending : endings) {
      if (taken_.contains(key(ending))) return false;
    }
    for (const std::string_view ending : endings) taken_.insert(key(ending));
    return true;
  }

 private:
  const NameRule& rule_;
  std::set<std::string> taken_;
};

}  // namespace

std::span<const std::string_view> component_endings(std::uint32_t components) noexcept {
  static constexpr std::array<std::string_view, 1> kOne{""};
  static constexpr std::array<std::string_view, 3> kThree{"_x", "_y", "_z"};
  if (components == 1) return kOne;
  return kThree;
}

std::vector<std::string> array_names_in_file(std::span<const std::string> names,
                                             std::span<const std::uint32_t> components,
                                             const NameRule& rule) {
  TakenNames taken(rule);
  std::vector<std::string> free_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::span<const std::string_view> endings = component_endings(components[i]);
    const std::string wanted = with_good_characters(names[i], rule);
    std::string free = wanted;
    for (int number = 2; !taken.take(free, endings); ++number) {
      const std::string ending = absl::StrCat("_", number);
      free = cut(wanted, rule.most_bytes - ending.size()) + ending;
    }
    free_names.push_back(free);
  }
  return free_names;
}

std::vector<std::string> names_in_file(std::span<const std::string> names,
                                       const NameRule& rule) {
  return array_names_in_file(names, std::vector<std::uint32_t>(names.size(), 1), rule);
}

}  // namespace tet
