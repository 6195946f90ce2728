// What is kept of a finest brick between counting and filling.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_points.h"
#include "core/stuffing/stencil.h"
#include "core/stuffing/stuffing_rules.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Cells whose tets reach a brick.
inline constexpr HaloSet kCellsAround = halo_cube(kNodeMin, 7);

/// Signs of a brick's own nodes after the warp, and its own cut points. All other nodes are
/// `-`.
struct StuffedBrick {
  NodeMasks plus;
  NodeMasks zero;  ///< only zeros that some tet has
  std::array<BrickMask, kEdgeFamilies> cut;

  /// A brick far inside: every node is `+`.
  static StuffedBrick all_inside() noexcept;
};

/// Tets whose surface quad has a vertex in its middle, by shape and by the cell they belong to;
/// only where both sides are meshed.
using FanMasks = std::array<BrickMask, kTetShapes>;

/// True when the surface reaches the brick: some tet is cut or has a moved node.
bool touches_surface(const WarpedLattice& lattice, const StuffingRules& rules) noexcept;

/// Where a brick's cells and nodes have `+` nodes around them, each step looked up once.
class PlusAround {
 public:
  explicit PlusAround(const WarpedLattice& lattice) noexcept;

  /// Says for each of the brick's own nodes whether the node of `kind` a step on is `+`. Steps
  /// to the corners of a cell, to the centres around a corner, and across faces.
  const BrickMask& at(NodeKind kind, LatticeCoord step) const noexcept {
    return at_[place(kind, step)];
  }

 private:
  static constexpr std::size_t kSteps = 8 + 3;
  /// Corners lie above cells and centres below corners; then come the three other faces.
  static constexpr std::size_t place(NodeKind kind, LatticeCoord step) noexcept {
    const int sign = kind == kCorner ? 1 : -1;
    const int up = sign * (4 * step.x + 2 * step.y + step.z);
    const int other = up == -4 ? 8 : up == -2 ? 9 : 10;
    return kSteps * kind + static_cast<std::size_t>(up >= 0 ? up : other);
  }

  std::array<BrickMask, kNodeKinds * kSteps> at_;
};

/// `plus` is of this lattice.
StuffedBrick keep_brick(const WarpedLattice& lattice,
                        const PlusAround& plus,
                        const StuffingRules& rules) noexcept;

/// Cells of the brick that have a part in a tet that is meshed and cut or moved: only those
/// must stay finest. One-sided, such a tet has both `+` and other nodes. `plus` is of this
/// lattice.
BrickMask stuffed_cells(const WarpedLattice& lattice,
                        const PlusAround& plus,
                        const StuffingRules& rules) noexcept;

/// A finest brick and the seven beyond its upper faces, edges and corner, which its tets reach
/// into; at 4*x + 2*y + z. Null where every node is `-`.
using BrickNeighbourhood = std::array<const StuffedBrick*, 8>;

/// The nodes [0, 8]^3 that a brick's tets use, and the finest leaves in its halo.
///
/// `+` is the side of `region`, so that one set of rules meshes either.
struct FinestNodes {
  std::array<HaloSet, kNodeKinds> plus, zero;
  HaloSet leaf;
  MeshRegion region = MeshRegion::kInside;
};

/// The nodes as the inside sees them.
FinestNodes gather_nodes(const BrickNeighbourhood& bricks, const HaloSet& leaf) noexcept;

/// The nodes as the outside sees them. Tets with four zeros are the outside's.
FinestNodes seen_from_outside(const FinestNodes& inside) noexcept;

/// Nodes of the brick that are vertices of a one-sided mesh: used zeros, and `+` nodes of
/// finest leaves.
NodeMasks finest_vertices(const StuffedBrick& brick, const LowerLeaves& leaves) noexcept;

/// A brick and the 26 around it, at 9*(x+1) + 3*(y+1) + z+1; null where every node is `-`.
using BrickSurroundings = std::array<const StuffedBrick*, 27>;

/// The brick's own edges that have a cut point after the warp, from signs alone: one end is
/// `+`, the other `-`.
std::array<BrickMask, kEdgeFamilies> edges_cut(const BrickSurroundings& bricks) noexcept;

/// What a mesh of both sides uses of a brick: the nodes, and the edges, of all its tets. At the
/// edge of the domain that is less than everything.
struct UsedByTets {
  NodeMasks node;
  std::array<BrickMask, kEdgeFamilies> edge;
};

UsedByTets used_by_tets(const BrickSurroundings& bricks, const HaloSet& leaf) noexcept;

/// The six nodes around every cell's upper face across one axis, by the cell: what the four tet
/// shapes around the face choose theirs from (see TetShape::face_node).
struct FaceSigns {
  std::array<HaloSet, kFaceNodes> plus, zero;
  HaloSet tets;  ///< cells of the brick whose face has finest leaves on both sides
  MeshRegion region = MeshRegion::kInside;
};

/// `cells` are those whose tets are meant.
FaceSigns signs_around_faces(const FinestNodes& nodes,
                             int axis,
                             const HaloSet& cells = kOwnCells) noexcept;

/// One tet shape's tets within a brick, by the cell they belong to.
struct ShapeSigns {
  std::array<const HaloSet*, 4> plus, zero;  ///< of the four nodes; within the FaceSigns
  HaloSet whole;    ///< no `-` node and at least one `+`; outside also four zeros
  HaloSet regular;  ///< all `+`: nothing moved, a BCC tet
  HaloSet cut;      ///< at least one `+` and one `-`
  MeshRegion region = MeshRegion::kInside;
};

ShapeSigns signs_of_shape(const FaceSigns& faces, const TetShape& shape) noexcept;

/// Sign of node `i` of the tet in `cell`.
inline NodeSign sign_at(const ShapeSigns& signs, std::size_t i, int cell) noexcept {
  if (signs.plus[i]->test(cell)) return NodeSign::kPlus;
  return signs.zero[i]->test(cell) ? NodeSign::kZero : NodeSign::kMinus;
}

/// Finest cells among `own` whose half pyramids across `direction` are meshed: the face leads
/// to a larger leaf or out of the domain, and its nodes are all `+`.
HaloSet cells_with_half_pyramids(const FinestNodes& nodes,
                                 const HaloSet& own,
                                 int direction) noexcept;

}  // namespace tet
