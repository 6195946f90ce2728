// Whether a chunk is still wanted while it is filled.
#pragma once

#include <absl/status/status.h>

#include "core/base/cancel.h"
#include "core/base/check_stopped.h"
#include "core/plan/mesh_workspace.h"

namespace tet {

/// What fills a chunk looks at it between bricks: a thing of its workspace. Nobody cancels what
/// is filled without a WatchedFill.
class FillWatch {
 public:
  /// True from the first look on that found the chunk unwanted, whatever clocks do then: its
  /// columns are not whole, and must not be read.
  bool stops() noexcept {
    stopped_ = stopped_ || (cancellation_ != nullptr && cancellation_->requested());
    return stopped_;
  }
  /// The same, without a look.
  bool stopped() const noexcept { return stopped_; }

 private:
  friend class WatchedFill;
  const Cancellation* cancellation_ = nullptr;
  bool stopped_ = false;
};

/// For as long as it lives, filling with a workspace stops between bricks once it is cancelled.
/// Both must outlive it; one at a time for a workspace.
class WatchedFill {
 public:
  WatchedFill(MeshWorkspace& workspace, const Cancellation& cancellation)
      : watch_(workspace.get<FillWatch>()), cancellation_(cancellation) {
    watch_.cancellation_ = &cancellation;
  }
  ~WatchedFill() { watch_ = {}; }
  WatchedFill(const WatchedFill&) = delete;
  WatchedFill& operator=(const WatchedFill&) = delete;

  /// Whether something that was filled is not whole.
  bool stopped() const noexcept { return watch_.stopped(); }
  /// OK where all is whole. Errors: kDeadlineExceeded, kCancelled.
  absl::Status status() const {
    return stopped() ? check_stopped(true, cancellation_) : absl::OkStatus();
  }

 private:
  FillWatch& watch_;
  const Cancellation& cancellation_;
};

}  // namespace tet
