// The percentiles that reports show.
#pragma once

#include <array>

#include "bench/load/latency_goal.h"

namespace tet::load {

struct Quantile {
  const char* name;
  const char* key;  ///< in JSON
  double fraction;
};
inline constexpr std::array kQuantiles{Quantile{"p50", "p50", 0.5}, Quantile{"p90", "p90", 0.9},
                                       Quantile{"p99", "p99", 0.99},
                                       Quantile{"p99.9", "p99_9", 0.999}};

inline constexpr std::array kLatencyKinds{LatencyKind::kHeader, LatencyKind::kFirstChunk,
                                          LatencyKind::kWhole};

}  // namespace tet::load
