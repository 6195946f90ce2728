// Being called back when work is cancelled.
#pragma once

#include <cstdint>
#include <functional>

#include "core/base/cancel.h"

namespace tet {

/// Calls `action` once when `cancellation` is raised or its deadline passes; also when that was
/// before. One thread of the process, which sleeps until then, calls all of them, so an action
/// must be short. It may destroy its own OnCancel.
///
/// Thread safety: as any object; the destructor returns when the action does not run, and it
/// will not.
class OnCancel {
 public:
  /// `cancellation` must outlive this.
  OnCancel(const Cancellation& cancellation, std::function<void()> action);
  ~OnCancel();
  OnCancel(const OnCancel&) = delete;
  OnCancel& operator=(const OnCancel&) = delete;

 private:
  const std::uint64_t entry_;
};

}  // namespace tet
