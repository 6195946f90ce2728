// What is kept of a finest brick between counting and filling.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_points.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Signs of a brick's own nodes after the warp, and its own cut points. All other nodes are
/// `-`.
struct StuffedBrick {
  std::array<BrickMask, kNodeKinds> plus;
  std::array<BrickMask, kNodeKinds> zero;  ///< only zeros that some tet uses
  std::array<BrickMask, kEdgeFamilies> cut;

  /// A brick far inside: every node is `+`.
  static StuffedBrick all_inside() noexcept;
};

StuffedBrick keep_brick(const WarpedLattice& lattice) noexcept;

/// Cells of the brick that have a part in a tet with both `+` and other nodes: only those tets
/// are cut or moved, so only those cells must stay finest.
BrickMask stuffed_cells(const WarpedLattice& lattice) noexcept;

/// A finest brick and the seven beyond its upper faces, edges and corner, which its tets reach
/// into; at 4*x + 2*y + z. Null where every node is `-`.
using BrickNeighbourhood = std::array<const StuffedBrick*, 8>;

/// The nodes [0, 8]^3 that a brick's tets use, and the finest leaves in its halo.
struct FinestNodes {
  std::array<HaloSet, kNodeKinds> plus, zero;
  HaloSet leaf;
};

FinestNodes gather_nodes(const BrickNeighbourhood& bricks, const HaloSet& leaf) noexcept;

/// Nodes of the brick that are vertices: used zeros, and `+` nodes of finest leaves.
std::array<BrickMask, kNodeKinds> finest_vertices(const StuffedBrick& brick,
                                                  const HaloSet& leaf) noexcept;

/// The six nodes around every cell's upper face across one axis, by the cell: what the four tet
/// shapes around the face choose theirs from (see TetShape::face_node).
struct FaceSigns {
  std::array<HaloSet, kFaceNodes> plus, zero;
  HaloSet tets;  ///< cells of the brick whose face has finest leaves on both sides
};

FaceSigns signs_around_faces(const FinestNodes& nodes, int axis) noexcept;

/// One tet shape's tets within a brick, by the cell they belong to.
struct ShapeSigns {
  std::array<const HaloSet*, 4> plus, zero;  ///< of the four nodes; within the FaceSigns
  HaloSet whole;                             ///< no `-` node and at least one `+`
  HaloSet regular;                           ///< all `+`: nothing moved, a BCC tet
  HaloSet cut;                               ///< at least one `+` and one `-`
};

ShapeSigns signs_of_shape(const FaceSigns& faces, const TetShape& shape) noexcept;

/// Tets that the stencils and the half pyramids of a finest brick emit.
std::uint64_t count_finest(const FinestNodes& nodes) noexcept;

}  // namespace tet
