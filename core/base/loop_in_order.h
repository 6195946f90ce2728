// Loops of one thread that stop early.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/cancel.h"

namespace tet {

/// Calls `body(i)` for each i in [0, count), one after the other, until work is to stop.
template <class Body>
void for_each_in_order(std::uint64_t count,
                       const Cancellation& cancellation,
                       const Body& body) {
  constexpr std::uint64_t kBetweenLooks = 1 << 16;
  for (std::uint64_t begin = 0; begin < count && !cancellation.requested();) {
    const std::uint64_t end = std::min(count, begin + kBetweenLooks);
    for (; begin < end; ++begin) body(begin);
  }
}

}  // namespace tet
