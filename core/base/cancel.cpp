#include "core/base/cancel.h"

namespace tet {

absl::Status check_cancelled(const Cancellation& cancellation) {
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  if (cancellation.requested()) return absl::CancelledError("cancelled by the caller");
  return absl::OkStatus();
}

}  // namespace tet
