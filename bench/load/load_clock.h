// The clock that requests are scheduled and measured by.
#pragma once

#include <chrono>
#include <cmath>

namespace tet::load {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;
using Nanoseconds = std::chrono::nanoseconds;

inline Nanoseconds from_seconds(double seconds) {
  return Nanoseconds(std::llround(seconds * 1e9));
}
inline double to_seconds(Nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}
inline double to_ms(Nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace tet::load
