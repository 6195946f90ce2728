// One lattice tet that the surface cuts, and all that its stencil asks for.
#pragma once

#include <algorithm>
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

/// The mean of the cut points of a tet of `shape` in `cell` that has a quad.
WorldPoint middle_of_quad(const TetShape& shape,
                          int cell,
                          const StuffedLattice& lattice) noexcept;

/// A tet with at least one node cut away.
class CutTet {
 public:
  CutTet(const TetShape& shape,
         const ShapeSigns& signs,
         int cell,
         const StuffedLattice& lattice,
         const StuffingRules& rules) noexcept;

  /// The tets of its region that stand for it.
  std::span<const std::array<StencilVertex, 4>> tets() const noexcept;

  /// Two nodes on either side: the surface crosses it in a quad.
  bool has_quad() const noexcept { return plus_.count == 2 && minus_.count == 2; }
  /// The faces of both regions force their own diagonal on the quad.
  bool has_fan() const noexcept;
  QuadSplit quad_split() const noexcept;

  /// Halo index of the cell it belongs to.
  int cell() const noexcept { return cell_; }
  /// Halo index of one of the four nodes.
  std::size_t node(std::size_t i) const noexcept {
    return static_cast<std::size_t>(cell_ + shape_.offset[i]);
  }
  /// Where a corner of a stencil lies, in units of the spacing from the brick's lowest corner.
  WorldPoint place(StencilVertex vertex) const noexcept;

 private:
  struct Nodes {
    std::array<std::size_t, 4> at{};
    std::size_t count = 0;
    void add(std::size_t node) noexcept { at[count++] = node; }
  };

  float column(std::size_t plus, std::size_t minus) const noexcept;
  bool second_longer(std::size_t p, std::size_t q, std::size_t minus) const noexcept;
  std::size_t column_choice() const noexcept;
  struct Quad {
    const Nodes& plus;
    const Nodes& minus;
  };
  Quad quad() const noexcept;
  std::optional<QuadSplit> forced_split(const Nodes& plus, const Nodes& minus) const noexcept;
  WorldPoint place_of_cut(std::size_t a, std::size_t b) const noexcept;

  const TetShape& shape_;
  const StuffedLattice& lattice_;
  const StuffingRules& rules_;
  int cell_;
  MeshRegion region_;
  std::array<NodeSign, 4> sign_{};
  Nodes plus_, minus_;  ///< ascending; `+` is the region's own side
};

/// Tets of the brick's own cells that have a fan, by shape and cell.
FanMasks find_fans(const StuffedLattice& lattice,
                   const FinestNodes& nodes,
                   const StuffingRules& rules) noexcept;

// In the header because they run for every tet at the surface.

inline CutTet::CutTet(const TetShape& shape,
                      const ShapeSigns& signs,
                      int cell,
                      const StuffedLattice& lattice,
                      const StuffingRules& rules) noexcept
    : shape_(shape), lattice_(lattice), rules_(rules), cell_(cell), region_(signs.region) {
  for (std::size_t i = 0; i < 4; ++i) {
    sign_[i] = sign_at(signs, i, cell);
    if (sign_[i] == NodeSign::kPlus) plus_.add(i);
    if (sign_[i] == NodeSign::kMinus) minus_.add(i);
  }
}

/// Length of the column on the edge from a `+` node to a `-` node.
inline float CutTet::column(std::size_t plus, std::size_t minus) const noexcept {
  const std::size_t low = std::min(plus, minus);
  const float fraction =
      lattice_.cuts.fraction[shape_.edge_family[edge_between(plus, minus)]][node(low)];
  return plus == low ? fraction : 1 - fraction;
}

/// True when q's column is the longer one; p is the lower node and wins a tie.
inline bool CutTet::second_longer(std::size_t p,
                                  std::size_t q,
                                  std::size_t minus) const noexcept {
  return column(q, minus) > column(p, minus);
}

/// The bits of a stencil's choice that column lengths decide.
inline std::size_t CutTet::column_choice() const noexcept {
  if (plus_.count == 1) return 0;
  const auto [p, q, r, s] = plus_.at;
  const auto [m, n, o, t] = minus_.at;
  std::size_t choice = second_longer(p, q, m) ? 1 : 0;
  if (plus_.count == 3) {
    choice |= (second_longer(p, r, m) ? 2 : 0) | (second_longer(q, r, m) ? 4 : 0);
  } else if (minus_.count == 2) {
    choice |= second_longer(p, q, n) ? 2 : 0;
  }
  return choice;
}

inline std::span<const std::array<StencilVertex, 4>> CutTet::tets() const noexcept {
  const std::size_t number = stencil_number(sign_[0], sign_[1], sign_[2], sign_[3]);
  std::size_t choice = column_choice();
  if (has_quad()) {
    const QuadSplit split = quad_split();
    if (split == QuadSplit::kFan) {
      const Fan& fan = kFans[number][choice];
      return std::span(fan.tet).first(fan.tet_count);
    }
    choice |= split == QuadSplit::kSecondDiagonal ? 4 : 0;
  }
  const Stencil& stencil = kStencils[number][choice];
  return std::span(stencil.tet).first(stencil.tet_count);
}

inline WorldPoint CutTet::place(StencilVertex vertex) const noexcept {
  if (vertex < 4) {
    return lattice_.place_of_node(shape_.kind[vertex], static_cast<int>(node(vertex)));
  }
  if (vertex == kQuadCentre) return middle_of_quad(shape_, cell_, lattice_);
  const auto edge = static_cast<std::size_t>(vertex - 4);
  return lattice_.place_of_cut(shape_.edge_family[edge],
                               static_cast<int>(node(kTetEdge[edge][0])));
}

}  // namespace tet
