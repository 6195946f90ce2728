// The edges of a background that the surface crosses, and where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/field/phi_field.h"
#include "core/graded/background_mesh.h"

namespace tet {

/// Edges between a node inside and one outside, by their lower nodes, then by the upper ones.
struct SurfaceEdges {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::vector<std::uint32_t>
      first;  ///< of each node, its first edge to a higher one; and one more
  std::vector<NodeId> high;
  std::vector<float> fraction;  ///< of the way from the lower node to where phi is zero

  std::size_t count() const noexcept { return high.size(); }
  /// The edge between two nodes, or kNone.
  std::uint32_t find(NodeId low, NodeId high_node) const noexcept;
};

/// Finds the edges that the surface crosses, without their fractions. If cancelled, discard the
/// result.
SurfaceEdges find_surface_edges(const BackgroundMesh& mesh, const Cancellation& cancellation);

/// Finds fractions that are within kZeroTolerance of a zero of the field. Parallel.
void find_zeros(const BackgroundMesh& mesh,
                const PhiField& field,
                const Cancellation& cancellation,
                SurfaceEdges& edges);

}  // namespace tet
