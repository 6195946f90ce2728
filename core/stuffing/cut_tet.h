// One lattice tet that the surface cuts, and all that its stencil asks for.
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

}  // namespace tet
