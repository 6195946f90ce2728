// How many tets a finest brick's cells carry, and how many triangles the surface has in them:
// 64 cells at once.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

/// Tets that the stencils and the half pyramids of a finest brick emit in one region. `fans` is
/// null where there are none.
std::uint64_t count_finest(const CellNodes& nodes, const FanMasks* fans) noexcept;

/// One shape's tets within a brick, by the cell they belong to, and by how many stand for each.
struct NumberedShape {
  BrickMask whole;  ///< one
  BrickMask cut;    ///< one, but for those of the next two; and a fan's, of six
  BrickMask in_two, in_three;

  /// How many stand for cut ones of a slice; `fans` are those among them that have one.
  std::uint64_t count_cut(std::size_t x,
                          std::uint64_t cells,
                          std::uint64_t fans) const noexcept {
    const auto count = [cells](std::uint64_t bits) {
      return static_cast<std::uint64_t>(std::popcount(cells & bits));
    };
    // A fan stands where three would.
    return count(cut.slice[x]) + count(in_two.slice[x]) + 2 * count(in_three.slice[x]) +
           3 * count(fans);
  }
};

/// `shape` is an index of kTetShape.
NumberedShape number_shape(const CellNodes& nodes, std::size_t shape) noexcept;

/// Tets of a brick's cells with one `+` and three zeros, by shape.
using ThreeZeros = std::array<BrickMask, kTetShapes>;

/// Those of one shape.
void find_three_zeros(const CellNodes& nodes, ThreeZeros& three_zeros) noexcept;

/// For each node of a shape, how far from the cell the node opposite it lies, across the face
/// of the other three: the mirror image in the middle of the tet's other long edge.
inline constexpr std::array<std::array<int, 4>, kTetShapes> kMirrored = [] {
  std::array<std::array<int, 4>, kTetShapes> mirrored{};
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    const TetShape& shape = kTetShape[s];
    for (std::size_t a = 0; a < 4; ++a) {
      LatticeCoord at{};
      for (std::size_t b = 0; b < 4; ++b) {
        const LatticeCoord node =
            node_coord(shape.kind[b], halo_index(0, 0, 0) + shape.offset[b]);
        if (b == a) at = at - node;
        if (shape.kind[b] != shape.kind[a]) at = at + node;
      }
      mirrored[s][a] = node_index(at) - halo_index(0, 0, 0);
    }
  }
  return mirrored;
}();

/// What count_finest counts, and triangles of the surface within the brick's cut tets.
struct FinestCounts {
  std::uint64_t tets = 0, triangles = 0;
};

/// Counts both of the inside in one pass; notes tets that may have a triangle on a face.
FinestCounts count_finest_and_surface(const CellNodes& nodes,
                                      const FanMasks* fans,
                                      ThreeZeros& three_zeros) noexcept;

}  // namespace tet
