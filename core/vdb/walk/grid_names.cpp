#include "core/vdb/walk/grid_names.h"

#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>

#include "core/base/utf8.h"
#include "core/volume/grid_info.h"

namespace tet {
namespace {

constexpr char kSuffixSeparator = '\x1e';
constexpr std::size_t kSuffixBytes = 16;  // enough for "[n]"

/// A stored name, taken apart.
struct StoredName {
  std::string text;
  bool is_numbered = false;
  std::uint32_t number = 0;
};

StoredName parse_name(const std::string& stored) {
  const std::size_t at = stored.find(kSuffixSeparator);
  StoredName name;
  name.text = as_utf8(stored.substr(0, at), kMaxGridNameBytes - kSuffixBytes);
  name.is_numbered = at != std::string::npos;
  if (!name.is_numbered) return name;
  const std::string suffix = stored.substr(at + 1);
  if (absl::SimpleAtoi(suffix, &name.number)) return name;
  name.number = 0;  // no library numbers them so, and any number will do
  return name;
}

}  // namespace

std::vector<std::string> shown_names(std::span<const std::string> stored) {
  std::vector<StoredName> names;
  for (const std::string& name : stored) names.push_back(parse_name(name));
  std::vector<std::string> shown(names.size());
  std::set<std::string> taken;
  // Names that nobody numbered come first: they are what their makers call them.
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_any = names[i].text.empty() && names.size() > 1;
    if (names[i].is_numbered || is_any) continue;
    if (taken.insert(names[i].text).second) {
      shown[i] = names[i].text;
    } else {
      names[i].is_numbered = true;  // it is another's, told in another encoding
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!shown[i].empty() || (names.size() == 1 && !names[i].is_numbered)) continue;
    const auto next = [&] {
      return shown[i] = absl::StrCat(names[i].text, "[", names[i].number++, "]");
    };
    while (!taken.insert(next()).second) continue;
  }
  return shown;
}

}  // namespace tet
