// The positions of one brick's own vertices, as a mesh stores them.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/types.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// Where a brick lies among a mesh's stored positions.
class BrickFrame {
 public:
  BrickFrame(const LatticeToWorld& to_world, BrickCoord brick, int level) noexcept;

  /// Takes units of the cell's edge to those of the spacing.
  double edge() const noexcept { return edge_; }
  /// Leads from the mesh's origin to the brick's lowest corner, in spacings: exact, however far
  /// away the grid lies.
  const std::array<double, 3>& corner() const noexcept { return corner_; }
  /// Row r of the linear map to world axes.
  const std::array<double, 3>& row(std::size_t r) const noexcept { return to_world_.linear[r]; }

 private:
  const LatticeToWorld& to_world_;
  double edge_;
  std::array<double, 3> corner_;
};

/// Writes the positions of a brick's vertices in the order of their ids. `places` has those
/// that are no lattice nodes; where nothing is zero or cut it is not looked at.
void write_positions(const BrickFrame& frame,
                     const OwnedVertices& own,
                     const OwnPlaces& places,
                     CoordinateType type,
                     std::span<std::byte> positions) noexcept;

}  // namespace tet
