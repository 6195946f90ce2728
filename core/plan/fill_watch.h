// Whether a chunk is still wanted while it is filled.
#pragma once

#include "core/base/cancel.h"
#include "core/plan/mesh_workspace.h"

namespace tet {

/// What fills a chunk looks at it between bricks, and within those that are much work: a thing
/// of its workspace. Nobody cancels what is filled without a WatchedFill.
class FillWatch {
 public:
  const Cancellation& cancellation() const noexcept {
    static const Cancellation never;
    return cancellation_ != nullptr ? *cancellation_ : never;
  }
  /// Whether the chunk is unwanted: its columns are not whole, and must not be read.
  bool stops() const noexcept { return cancellation().requested(); }

 private:
  friend class WatchedFill;
  const Cancellation* cancellation_ = nullptr;
};

/// For as long as it lives, filling with a workspace stops early once it is cancelled. Whoever
/// fills looks at the cancellation afterwards, and discards what it filled if it was requested.
/// Both must outlive it; one at a time for a workspace.
class WatchedFill {
 public:
  WatchedFill(MeshWorkspace& workspace, const Cancellation& cancellation)
      : watch_(workspace.get<FillWatch>()) {
    watch_.cancellation_ = &cancellation;
  }
  ~WatchedFill() { watch_ = {}; }
  WatchedFill(const WatchedFill&) = delete;
  WatchedFill& operator=(const WatchedFill&) = delete;

 private:
  FillWatch& watch_;
};

}  // namespace tet
