// Which tets the cells of a finest brick carry, by the signs of their nodes: 512 cells at once.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/brick_mask.h"
#include "core/base/brick_neighbours.h"
#include "core/base/mask_column.h"
#include "core/base/types.h"
#include "core/lattice/background.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

/// Leaves of a finest brick, and of those beyond its faces by direction (0..5: +x, +y, +z, -x,
/// -y, -z).
struct LeavesAround {
  const BrickMask* own;
  std::array<const BrickMask*, kFaceDirections> beyond;
};

/// Those of the finest brick in the middle of `places`; `leaf` has the finest level's.
LeavesAround leaves_around(const MaskColumn& leaf, const PlacesAround& places) noexcept;

/// The nodes around each cell of a finest brick, as one region sees them.
///
/// `plus[kind][o]` says of cell (x, y, z) whether the node of that kind at (x + (o >> 2),
/// y + (o >> 1 & 1), z + (o & 1)) is `+`, the side of `region`; `zero` likewise.
struct CellNodes {
  using AroundCells = std::array<BrickMask, 8>;
  std::array<AroundCells, kNodeKinds> plus, zero;
  std::array<BrickMask, 3> pairs;  ///< leaves with a leaf across their upper face, by axis
  std::array<BrickMask, kFaceDirections> ends;  ///< leaves without a leaf across a face
  MeshRegion region = MeshRegion::kInside;
};

/// Gathers the nodes around the cells of a brick as the inside sees them.
CellNodes nodes_around_cells(const BrickNeighbourhood& bricks,
                             const LeavesAround& leaves) noexcept;

/// Turns nodes as the inside sees them into nodes as the outside does.
void see_from_outside(CellNodes& nodes) noexcept;

/// Which of the eight a node of a tet shape is.
constexpr std::size_t node_around_cell(const TetShape& shape, std::size_t i) noexcept {
  const int offset = shape.offset[i];
  return static_cast<std::size_t>((offset >> 8) * 4 + (offset >> 4 & 1) * 2 + (offset & 1));
}

/// One tet shape's tets within a brick, by the cell they belong to.
struct ShapeTets {
  BrickMask whole;    ///< no `-` node and at least one `+`; outside also four zeros
  BrickMask regular;  ///< all `+`: nothing moved, a BCC tet
  BrickMask cut;      ///< at least one `+` and one `-`
};

/// `shape` is an index of kTetShape.
ShapeTets tets_of_shape(const CellNodes& nodes, std::size_t shape) noexcept;

/// Leaves whose two half pyramids across `direction` are meshed: the face leads to a larger
/// leaf or out of the domain, and its nodes are all `+`.
BrickMask half_pyramids_of_finest(const CellNodes& nodes, int direction) noexcept;

}  // namespace tet
