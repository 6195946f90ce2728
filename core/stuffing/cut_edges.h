// The lattice edges of a brick that the surface crosses: as sets, then as columns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/node_signs.h"

namespace tet {

/// Sets of edges, by family and lower node.
using EdgeSets = std::array<HaloSet, kEdgeFamilies>;

/// Edges are worked on this many at a time, one in each lane of a vector.
inline constexpr std::size_t kEdgeLanes = 16;

/// Cut edges as columns: family by family, each in the order of halo indices.
///
/// A family's run begins at a multiple of `kEdgeLanes` and is filled up to one with its last
/// edge, so that loops over lanes have no remainder.
struct CutEdges {
  /// Lower nodes lie in [-2, 8]^3.
  static constexpr std::size_t kMaxOfFamily =
      (11 * 11 * 11 + kEdgeLanes - 1) / kEdgeLanes * kEdgeLanes;
  static constexpr std::size_t kMax = kEdgeFamilies * kMaxOfFamily;

  struct Run {
    std::size_t begin = 0, count = 0;
    std::size_t padded() const noexcept {
      return (count + kEdgeLanes - 1) / kEdgeLanes * kEdgeLanes;
    }
  };
  std::array<Run, kEdgeFamilies> run;
  alignas(
      64) std::array<std::uint16_t, kMax + kEdgeLanes> low;  ///< halo index of the lower node
  alignas(64) std::array<float, kMax> fraction;  ///< where the edge is cut, from the lower node
};

/// Finds the edges whose ends have strictly opposite signs, among those with an end in
/// [kNodeMin, kNodeMax]^3. Their fractions are left open.
void find_cut_edges(const NodeSigns& signs, EdgeSets& cut, CutEdges& edges) noexcept;

}  // namespace tet
