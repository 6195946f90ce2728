#include "core/vdb/walk/walk_refusal.h"

#include <cstddef>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

namespace tet {
namespace {

constexpr std::size_t kQuotedCharacters = 64;
constexpr std::size_t kLongestMessage = 300;

}  // namespace

void refuse_at(std::uint64_t offset, const std::string& why) {
  const std::string message = absl::StrCat("at byte ", offset, ": ", why);
  throw WalkRefusal(absl::InvalidArgumentError(message.substr(0, kLongestMessage)));
}

void refuse_over_limit(const std::string& why) {
  throw WalkRefusal(absl::ResourceExhaustedError(why.substr(0, kLongestMessage)));
}

std::string quoted_name(const std::string& name) {
  const std::string escaped = absl::CHexEscape(name.substr(0, kQuotedCharacters));
  const bool cut = name.size() > kQuotedCharacters || escaped.size() > kQuotedCharacters;
  return absl::StrCat("'", escaped.substr(0, kQuotedCharacters), cut ? "...'" : "'");
}

}  // namespace tet
