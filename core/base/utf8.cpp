#include "core/base/utf8.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace tet {
namespace {

/// Bytes of the character that begins with `lead`; 0 if none does.
std::size_t length_of(std::uint8_t lead) noexcept {
  const int ones = std::countl_one(lead);
  if (ones == 0) return 1;
  return ones >= 2 && ones <= 4 && lead >= 0xc2 ? static_cast<std::size_t>(ones) : 0;
}

/// The second byte decides whether a character is overlong, a surrogate, or beyond the last
/// one.
bool is_in_range(std::uint8_t lead, std::uint8_t second) noexcept {
  switch (lead) {
    case 0xe0:
      return second >= 0xa0;
    case 0xed:
      return second < 0xa0;
    case 0xf0:
      return second >= 0x90;
    case 0xf4:
      return second < 0x90;
    default:
      return lead < 0xf4;
  }
}

bool continues(char byte) noexcept { return (static_cast<std::uint8_t>(byte) & 0xc0) == 0x80; }

}  // namespace

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const auto lead = static_cast<std::uint8_t>(text[0]);
    const std::size_t length = length_of(lead);
    if (length == 0 || length > text.size()) return false;
    const std::string_view rest = text.substr(1, length - 1);
    if (!std::all_of(rest.begin(), rest.end(), continues)) return false;
    if (length > 1 && !is_in_range(lead, static_cast<std::uint8_t>(text[1]))) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string as_utf8(std::string_view text, std::size_t most_bytes) {
  if (is_utf8(text)) return std::string(text);
  // Latin-1's characters have the numbers that they have in Unicode.
  std::string utf8;
  for (const char c : text) {
    if (utf8.size() + 2 > most_bytes) break;
    const auto code = static_cast<std::uint8_t>(c);
    if (code < 0x80) {
      utf8.push_back(c);
    } else {
      utf8.push_back(static_cast<char>(0xC0 | code >> 6));
      utf8.push_back(static_cast<char>(0x80 | (code & 0x3F)));
    }
  }
  return utf8;
}

std::string cut_utf8(std::string_view text, std::size_t most_bytes) {
  std::string cut;
  while (!text.empty()) {
    const auto lead = static_cast<std::uint8_t>(text[0]);
    const std::size_t length = std::max<std::size_t>(1, length_of(lead));
    if (length > text.size() || cut.size() + length > most_bytes) break;
    const bool controls = lead == 0xc2 && static_cast<std::uint8_t>(text[1]) < 0xa0;
    if (!controls) cut.append(text.substr(0, length));
    text.remove_prefix(length);
  }
  return cut;
}

}  // namespace tet
