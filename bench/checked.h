// For benchmarks, which have nobody to tell an error to.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <utility>

#include <absl/status/statusor.h>

namespace tet::bench {

/// The value, or the end of the program.
template <class T>
T checked(absl::StatusOr<T> value) {
  if (value.ok()) return *std::move(value);
  std::fprintf(stderr, "%s\n", value.status().ToString().c_str());
  std::abort();
}

/// CPU time of all threads together since the process began.
inline double process_cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

}  // namespace tet::bench
