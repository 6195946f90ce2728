// Signs of all tets of a brick at once: one bit a cell, one mask for each node around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/lattice/bcc.h"

namespace tet {

/// The nodes that a cell's tets have: its own centre and those beyond its upper faces, then its
/// corners (dx, dy, dz) at 4 + 4*dx + 2*dy + dz.
inline constexpr std::size_t kCellNodes = 12;

/// Where each of them lies, as a halo offset, and its kind.
struct CellNode {
  NodeKind kind;
  std::int8_t dx, dy, dz;
};
inline constexpr std::array<CellNode, kCellNodes> kCellNode = [] {
  std::array<CellNode, kCellNodes> nodes{};
  for (std::int8_t n = 0; n < 4; ++n) {
    nodes[static_cast<std::size_t>(n)] = {kCentre, n == 1, n == 2, n == 3};
  }
  for (std::int8_t o = 0; o < 8; ++o) {
    const auto bit = [&](int b) { return static_cast<std::int8_t>(o >> b & 1); };
    nodes[static_cast<std::size_t>(4 + o)] = {kCorner, bit(2), bit(1), bit(0)};
  }
  return nodes;
}();

/// Signs of the nodes around every cell of a brick. A node that is in neither is `-`.
struct TetSigns {
  std::array<BrickMask, kCellNodes> plus, zero;
};

/// Which cells have four tets around their upper face across each axis.
using FaceMasks = std::array<BrickMask, 3>;

/// Tets of the brick's own cells with one `+` and three zeros, by shape.
using ThreeZeros = std::array<BrickMask, kTetShapes>;

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

/// `plus` and `zero` are valid for nodes in [0, 8]^3.
TetSigns signs_around_cells(const std::array<HaloSet, kNodeKinds>& plus,
                            const std::array<HaloSet, kNodeKinds>& zero) noexcept;

/// The same as the outside sees them.
TetSigns seen_from_outside(const TetSigns& inside) noexcept;

/// Tets that the stencils emit for the tets around `faces`: 1 for a whole one, and more where
/// nodes are cut away (see stencil.h).
std::uint64_t count_stencil_tets(const TetSigns& signs,
                                 const FaceMasks& faces,
                                 MeshRegion region) noexcept;

/// Triangles of the surface within cut tets, all of the brick's own; notes those tets that may
/// have one on a face.
std::uint64_t count_cut_triangles(const TetSigns& signs, ThreeZeros& three_zeros) noexcept;

}  // namespace tet
