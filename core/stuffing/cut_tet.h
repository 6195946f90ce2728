// One lattice tet that the surface cuts: which tets stand for it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/lattice/bcc.h"
#include "core/stuffing/stencil.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/stuffed_lattice.h"

namespace tet {

/// How the surface quad a, b, c, d of `++--` is divided, where p and q are the `+` nodes, m and
/// n the `-` nodes, and a, b, c, d the cut points on pm, qm, qn and pn.
enum class QuadSplit : std::uint8_t { kFirstDiagonal /* a-c */, kSecondDiagonal, kFan };

/// Where the cut points on a tet's edges lie, from the lower nodes; anything where there is
/// none.
using EdgeFractions = std::array<float, kTetEdge.size()>;

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
        nodes_(internal::kSortedNodes[number]),
        fraction_(fraction),
        region_(region),
        rules_(rules) {}

  /// Some column's length matters: with one `+` node the stencil has no choice.
  static bool has_columns(std::size_t number) noexcept {
    return internal::kSortedNodes[number].plus_count > 1;
  }

  /// The tets of its region that stand for it.
  StencilTets tets() const noexcept;

  /// Two nodes on either side: the surface crosses it in a quad.
  bool has_quad() const noexcept { return nodes_.plus_count == 2 && nodes_.minus_count == 2; }
  /// The faces of both regions force their own diagonal on the quad.
  bool has_fan() const noexcept;
  QuadSplit quad_split() const noexcept;

 private:
  using Nodes = std::array<std::uint8_t, 4>;
  struct Quad {
    const Nodes& plus;
    const Nodes& minus;
  };

  float column(std::size_t plus, std::size_t minus) const noexcept;
  bool second_longer(std::size_t p, std::size_t q, std::size_t minus) const noexcept;
  std::size_t column_choice() const noexcept;
  Quad quad() const noexcept;
  std::optional<QuadSplit> forced_split(const Nodes& plus, const Nodes& minus) const noexcept;
  WorldPoint place_of_node(std::size_t node) const noexcept;
  WorldPoint place_of_cut(std::size_t a, std::size_t b) const noexcept;

  const TetShape& shape_;
  std::size_t number_;
  const internal::SortedNodes& nodes_;
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

/// Length of the column on the edge from a `+` node to a `-` node.
inline float CutTet::column(std::size_t plus, std::size_t minus) const noexcept {
  const float fraction = fraction_[edge_between(plus, minus)];
  return plus < minus ? fraction : 1 - fraction;
}

/// True when q's column is the longer one; p is the lower node and wins a tie.
inline bool CutTet::second_longer(std::size_t p,
                                  std::size_t q,
                                  std::size_t minus) const noexcept {
  return column(q, minus) > column(p, minus);
}

/// The bits of a stencil's choice that column lengths decide.
inline std::size_t CutTet::column_choice() const noexcept {
  if (nodes_.plus_count == 1) return 0;
  const auto [p, q, r, s] = nodes_.plus;
  const auto [m, n, o, t] = nodes_.minus;
  std::size_t choice = second_longer(p, q, m) ? 1 : 0;
  if (nodes_.plus_count == 3) {
    choice |= (second_longer(p, r, m) ? 2 : 0) | (second_longer(q, r, m) ? 4 : 0);
  } else if (nodes_.minus_count == 2) {
    choice |= second_longer(p, q, n) ? 2 : 0;
  }
  return choice;
}

inline StencilTets CutTet::tets() const noexcept {
  std::size_t choice = column_choice();
  if (has_quad()) {
    const QuadSplit split = quad_split();
    if (split == QuadSplit::kFan) return kFans[number_][choice].tets();
    choice |= split == QuadSplit::kSecondDiagonal ? 4 : 0;
  }
  return kStencils[number_][choice].tets();
}

}  // namespace tet
