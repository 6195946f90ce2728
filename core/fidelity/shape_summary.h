// What is told of the shapes of a mesh's tets, here and by a server.
#pragma once

#include <array>
#include <cstdint>

#include "core/mesh/tet_shapes.h"

namespace tet {

struct RatioSummary {
  double min = 0, mean = 0, max = 0;
  std::array<std::uint64_t, RatioStats::kBins> histogram{};

  friend bool operator==(const RatioSummary&, const RatioSummary&) = default;
};

/// What all tets are like. A mesh without tets has 0 everywhere.
struct ShapeSummary {
  RatioSummary scaled_jacobian, radius_ratio, edge_ratio;
  double shortest_edge = 0, longest_edge = 0;  ///< world units
  std::uint64_t not_positive = 0;              ///< tets whose volume is zero or less

  friend bool operator==(const ShapeSummary&, const ShapeSummary&) = default;
};

inline RatioSummary summary_of(const RatioStats& stats) noexcept {
  if (stats.count == 0) return {};
  return {stats.min, stats.mean(), stats.max, stats.histogram};
}

inline ShapeSummary summary_of(const ShapeStats& stats) noexcept {
  return {summary_of(stats.scaled_jacobian),
          summary_of(stats.radius_ratio),
          summary_of(stats.edge_ratio),
          stats.edges.min,
          stats.edges.max,
          stats.not_positive};
}

}  // namespace tet
