#include "core/files/file_names.h"

#include <set>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

namespace tet {
namespace {

std::string plain_name(const std::string& name, const NameRule& rule) {
  std::string plain;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_isalnum(byte) || c == '_') {
      plain += c;
    } else if ((byte & 0xC0U) != 0x80U) {  // one for a character, whatever bytes it has
      plain += '_';
    }
  }
  const bool has_start =
      !plain.empty() && absl::ascii_isalpha(static_cast<unsigned char>(plain[0]));
  if (plain.empty() || (rule.letter_first && !has_start)) plain.insert(plain.begin(), 'n');
  return plain.substr(0, rule.most_bytes);
}

}  // namespace

std::vector<std::string> names_in_file(std::span<const std::string> names,
                                       const NameRule& rule) {
  std::set<std::string> taken;
  std::vector<std::string> plain;
  const auto take = [&](const std::string& name) {
    return taken.insert(rule.ignores_case ? absl::AsciiStrToLower(name) : name).second;
  };
  for (const std::string& name : names) {
    const std::string wanted = plain_name(name, rule);
    std::string free = wanted;
    for (int number = 2; !take(free); ++number) {
      const std::string ending = absl::StrCat("_", number);
      free = wanted.substr(0, rule.most_bytes - ending.size()) + ending;
    }
    plain.push_back(free);
  }
  return plain;
}

}  // namespace tet
