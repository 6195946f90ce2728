#include "core/base/failure_name.h"

#include <absl/strings/cord.h>

namespace tet {

absl::Status named_failure(std::string_view name, absl::Status status) {
  status.SetPayload(kFailureNameUrl, absl::Cord(std::string(name)));
  return status;
}

std::string failure_name(const absl::Status& status) {
  const auto name = status.GetPayload(kFailureNameUrl);
  return name ? std::string(*name) : std::string();
}

}  // namespace tet
