// Ending another thread's poll(2).
#pragma once

#include "core/base/posix/descriptor.h"

namespace tet {

/// An event that poll(2) can wait for beside sockets: its descriptor is readable from `set` to
/// `reset`.
///
/// Thread safety: every member may be called from any thread at any time; `set` is also safe in
/// a signal handler.
class WakeEvent {
 public:
  /// Without a descriptor when the process has no more of them; polls then end by their time.
  WakeEvent() noexcept;

  int number() const noexcept { return event_.number(); }
  void set() noexcept;
  void reset() noexcept;

 private:
  Descriptor event_;
};

}  // namespace tet
