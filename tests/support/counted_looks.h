// How much work is done between looks at whether it is cancelled: counted, never timed.
#pragma once

#include <cstddef>

#include "core/base/cancel.h"

namespace tet::test {

/// Counts the looks at a cancellation in one thread, and is cancelled once there were `most`.
struct CountedLooks {
  static constexpr std::size_t kNever = 1'000'000'000;

  std::size_t most = kNever;
  std::size_t looks = 0;
  Cancellation cancellation{Cancellation::Clock::time_point::max(),
                            [this] { return ++looks > most; }};
};

}  // namespace tet::test
