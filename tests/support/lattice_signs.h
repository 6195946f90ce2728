// The sign of phi at every node of a box of the lattice: what vertices are held against.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/field/phi_field.h"
#include "core/lattice/bcc.h"

namespace tet::test {

/// Samples whole bricks as the mesher does; no cut points, no warps, no octree.
class LatticeSigns {
 public:
  /// Nodes of the bricks in [min, max].
  LatticeSigns(const PhiField& field, BrickCoord min, BrickCoord max);

  /// -1 inside, 0 on the surface, 1 outside; 1 beyond the box.
  int at(LatticeCoord node) const noexcept;
  /// Both strict.
  bool opposite(LatticeCoord a, LatticeCoord b) const noexcept { return at(a) * at(b) < 0; }
  /// One end is inside, the other zero.
  bool touch(LatticeCoord a, LatticeCoord b) const noexcept { return at(a) + at(b) == -1; }
  bool has_opposite_neighbour(LatticeCoord node) const noexcept;
  /// The node and its 14 neighbours have the sign: no cut point is near, whatever the warp.
  bool deep(LatticeCoord node, int sign) const noexcept;
  bool holds(LatticeCoord node) const noexcept;
  /// In the outermost bricks of the box, or beyond it.
  bool in_margin(LatticeCoord node) const noexcept;

  /// A number for each node of the box, below `node_count`.
  std::size_t index_of(LatticeCoord node) const noexcept;
  std::size_t node_count() const noexcept { return sign_.size(); }
  LatticeCoord node_of(std::size_t index) const noexcept;

 private:
  /// Within the box but for `margin` cells on every side.
  bool holds(LatticeCoord node, std::int32_t margin) const noexcept;

  BrickCoord min_;
  std::array<std::int32_t, 3> cells_{};
  std::vector<std::int8_t> sign_;  // corner and centre of each cell in turn
};

}  // namespace tet::test
