#include "core/base/printable.h"

#include <algorithm>
#include <cstdint>

#include "core/base/utf8.h"

namespace tet {
namespace {

constexpr char kHex[] = "0123456789abcdef";

/// The first character of a text that is not empty; of none that is UTF-8, the first byte.
struct FirstCharacter {
  std::string_view bytes;
  std::uint32_t code = 0;
  bool is_utf8 = false;
};

FirstCharacter first_of(std::string_view text) {
  for (std::size_t size = 1; size <= std::min<std::size_t>(4, text.size()); ++size) {
    const std::string_view bytes = text.substr(0, size);
    if (!is_utf8(bytes)) continue;
    const auto lead = static_cast<std::uint8_t>(bytes[0]);
    std::uint32_t code = size == 1 ? lead : lead & (0x7fu >> size);
    for (const char next : bytes.substr(1)) {
      code = code << 6 | (static_cast<std::uint8_t>(next) & 0x3f);
    }
    return {bytes, code, true};
  }
  return {text.substr(0, 1), static_cast<std::uint8_t>(text[0]), false};
}

bool is_between(std::uint32_t code, std::uint32_t first, std::uint32_t last) {
  return code >= first && code <= last;
}

/// Controls (C0, DEL, C1), marks that turn the direction of writing, separators of lines, and
/// what takes no room: two names that look alike are to be alike.
bool acts(std::uint32_t code) {
  return code < 0x20 || is_between(code, 0x7f, 0x9f) || code == 0xad || code == 0x61c ||
         code == 0x180e || is_between(code, 0x200b, 0x200f) ||
         is_between(code, 0x2028, 0x202e) || is_between(code, 0x2060, 0x206f) ||
         code == 0xfeff || is_between(code, 0xfff9, 0xfffb) ||
         is_between(code, 0xe0000, 0xe007f);
}

void add_hex(std::uint32_t value, int digits, std::string& out) {
  for (int digit = digits - 1; digit >= 0; --digit) out += kHex[value >> (4 * digit) & 0xf];
}

void add_escaped(const FirstCharacter& character, std::string& out) {
  if (character.code == '\n') {
    out += "\\n";
  } else if (character.code == '\r') {
    out += "\\r";
  } else if (character.code == '\t') {
    out += "\\t";
  } else if (!character.is_utf8 || character.code < 0x80) {
    out += "\\x";
    add_hex(character.code, 2, out);
  } else if (character.code < 0x10000) {
    out += "\\u";
    add_hex(character.code, 4, out);
  } else {
    out += "\\U";
    add_hex(character.code, 8, out);
  }
}

std::string escaped(std::string_view text, bool keep_lines) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const FirstCharacter first = first_of(text);
    const bool line_end = keep_lines && first.code == '\n' && first.is_utf8;
    if (line_end || (first.is_utf8 && !acts(first.code))) {
      out += first.bytes;
    } else {
      add_escaped(first, out);
    }
    text.remove_prefix(first.bytes.size());
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text, std::size_t limit) {
  std::string clean(text.substr(0, limit));
  const auto is_foreign = [](char c) { return c < ' ' || c > '~'; };
  std::replace_if(clean.begin(), clean.end(), is_foreign, '?');
  return clean;
}

std::string for_terminal(std::string_view text) { return escaped(text, false); }

std::string lines_for_terminal(std::string_view text) { return escaped(text, true); }

}  // namespace tet
