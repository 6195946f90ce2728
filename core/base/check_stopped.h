// What has stopped does not go on, whatever clocks say later.
#pragma once

#include <absl/status/status.h>

#include "core/base/cancel.h"

namespace tet {

/// OK, or why the work has to stop: always a reason where somebody has `stopped`. A clock may
/// have been set back since that look, and what was made up must not be used.
inline absl::Status check_stopped(bool stopped, const Cancellation& cancellation) {
  const absl::Status status = check_cancelled(cancellation);
  if (!stopped || !status.ok()) return status;
  return absl::DeadlineExceededError("the deadline passed");
}

}  // namespace tet
