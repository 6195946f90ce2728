#include "core/image/image_refusal.h"

#include <absl/strings/str_cat.h>

#include "core/base/printable.h"

namespace tet {

void refuse_image(const std::string& why) {
  throw ImageRefusal(absl::InvalidArgumentError(why));
}

void refuse_contents(const std::string& why) {
  throw ImageRefusal(absl::FailedPreconditionError(why));
}

std::string quoted_text(std::string_view text) {
  constexpr std::size_t kMost = 60;
  return absl::StrCat("'", printable(text, kMost), text.size() > kMost ? "..." : "", "'");
}

}  // namespace tet
