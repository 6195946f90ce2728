#include "core/base/cancel.h"

#include <memory>

#include "core/base/posix/wake_event.h"

namespace tet {

Cancellation::~Cancellation() { delete wake_.exchange(nullptr); }

// One of both sees what the other did, as neither may be moved before the other: whoever makes
// the event looks at the flag afterwards, and whoever raises the flag at the event.
void Cancellation::cancel() noexcept {
  cancelled_.store(true);
  if (WakeEvent* const wake = wake_.load()) wake->set();
}

int Cancellation::descriptor() const {
  WakeEvent* wake = wake_.load();
  if (wake == nullptr) {
    auto made = std::make_unique<WakeEvent>();
    if (wake_.compare_exchange_strong(wake, made.get())) wake = made.release();
    if (cancelled_.load()) wake->set();
  }
  return wake->number();
}

absl::Status check_cancelled(const Cancellation& cancellation) {
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  if (cancellation.requested()) return absl::CancelledError("cancelled by the caller");
  return absl::OkStatus();
}

}  // namespace tet
