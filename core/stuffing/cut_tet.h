// One lattice tet that the surface cuts: which tets stand for it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/lattice/bcc.h"
#include "core/stuffing/column_rule.h"
#include "core/stuffing/stencil.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/stuffed_lattice.h"

namespace tet {

/// A tet with at least one node cut away.
class CutTet {
 public:
  /// `number` is its stencil's, and tells its signs as `region` sees them.
  CutTet(const TetShape& shape,
         std::size_t number,
         const EdgeFractions& fraction,
         MeshRegion region,
         const StuffingRules& rules) noexcept
      : shape_(shape),
        number_(number),
        columns_(number, fraction),
        fraction_(fraction),
        region_(region),
        rules_(rules) {}

  /// Some column's length matters: with one `+` node the stencil has no choice.
  static bool has_columns(std::size_t number) noexcept {
    return internal::kSortedNodes[number].plus_count > 1;
  }

  /// The tets of its region that stand for it.
  StencilTets tets() const noexcept;

  bool has_quad() const noexcept { return columns_.has_quad(); }
  /// The faces of both regions force their own diagonal on the quad.
  bool has_fan() const noexcept;
  QuadSplit quad_split() const noexcept;

 private:
  using Nodes = ColumnRule::Nodes;
  struct Quad {
    const Nodes& plus;
    const Nodes& minus;
  };

  Quad quad() const noexcept;
  WorldPoint place_of_node(std::size_t node) const noexcept;
  WorldPoint place_of_cut(std::size_t a, std::size_t b) const noexcept;

  const TetShape& shape_;
  std::size_t number_;
  const ColumnRule columns_;
  const EdgeFractions& fraction_;
  MeshRegion region_;
  const StuffingRules& rules_;
};

/// Tets of the brick's own cells that have a fan, by shape and cell.
FanMasks find_fans(const StuffedLattice& lattice,
                   const FinestNodes& nodes,
                   const StuffingRules& rules) noexcept;

/// What a CutTet asks of the tet of `shape` in `cell` (a halo index).
std::size_t stencil_number(const ShapeSigns& signs, int cell) noexcept;
EdgeFractions edge_fractions(const StuffedLattice& lattice,
                             const TetShape& shape,
                             int cell) noexcept;

// In the header because they run for every tet at the surface.

inline StencilTets CutTet::tets() const noexcept {
  std::size_t choice = columns_.choice();
  if (has_quad()) {
    const QuadSplit split = quad_split();
    if (split == QuadSplit::kFan) return kFans[number_][choice].tets();
    choice |= split == QuadSplit::kSecondDiagonal ? 4 : 0;
  }
  return kStencils[number_][choice].tets();
}

}  // namespace tet
