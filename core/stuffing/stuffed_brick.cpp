#include "core/stuffing/stuffed_brick.h"

#include <cstddef>

#include "core/base/vector_clones.h"
#include "core/lattice/background.h"
#include "core/lattice/node_numbers.h"

namespace tet {
namespace {

/// Adds the nodes of the neighbour at (x, y, z), each -1, 0 or 1; null: every one is `-`.
void add_nodes(FinestNodes& nodes, const StuffedBrick* brick, int x, int y, int z) noexcept {
  if (brick == nullptr) return;
  for (const NodeKind kind : {kCorner, kCentre}) {
    add_brick(nodes.plus[kind], brick->plus[kind], x, y, z);
    add_brick(nodes.zero[kind], brick->zero[kind], x, y, z);
  }
}

void add_surroundings(FinestNodes& nodes, const BrickSurroundings& bricks) noexcept {
  for (int o = 0; o < 27; ++o) {
    add_nodes(nodes, bricks[static_cast<std::size_t>(o)], o / 9 - 1, o / 3 % 3 - 1, o % 3 - 1);
  }
}

/// The six nodes around the upper face across `axis` of the cell a step on: where some of them
/// are among these.
BrickMask any_around_face(const std::array<HaloSet, kNodeKinds>& nodes,
                          int axis,
                          LatticeCoord step) noexcept {
  BrickMask any =
      brick_part(nodes[kCentre], step) | brick_part(nodes[kCentre], step + face_step(axis));
  for (int turn = 0; turn < 4; ++turn) {
    any |= brick_part(nodes[kCorner], step + face_turn(axis, turn));
  }
  return any;
}

}  // namespace

StuffedBrick StuffedBrick::all_inside() noexcept {
  StuffedBrick brick;
  brick.plus.fill(BrickMask::all());
  return brick;
}

bool touches_surface(const WarpedLattice& lattice, const StuffingRules& rules) noexcept {
  if (has_both_sides(lattice)) return true;
  // Outside, a zero is a vertex whatever is around it, moved or not.
  return rules.both_sides && (lattice.zero[kCorner].any() || lattice.zero[kCentre].any());
}

PlusAround::PlusAround(const WarpedLattice& lattice) noexcept {
  for (const NodeKind kind : {kCorner, kCentre}) {
    const auto look = [&](LatticeCoord step) {
      at_[place(kind, step)] = brick_part(lattice.plus[kind], step);
    };
    // Cells have corners at their upper faces, and corners the centres of lower cells.
    for (int i = 0; i < 8; ++i) {
      const int sign = kind == kCorner ? 1 : -1;
      look({sign * (i >> 2), sign * (i >> 1 & 1), sign * (i & 1)});
    }
    for (int axis = 0; axis < 3; ++axis) look(face_step(kind == kCorner ? axis + 3 : axis));
  }
}

StuffedBrick keep_brick(const WarpedLattice& lattice,
                        const PlusAround& plus,
                        const StuffingRules& rules) noexcept {
  StuffedBrick brick;
  for (const NodeKind kind : {kCorner, kCentre}) {
    brick.plus[kind] = plus.at(kind, {});
    // Zeros beside a `+` are in tets.
    BrickMask beside_plus;
    for (int direction = 0; direction < kDirections; ++direction) {
      beside_plus |= plus.at(end_kind(kind, direction), end_step(kind, direction));
    }
    brick.zero[kind] = brick_part(lattice.zero[kind]) & beside_plus;
    // Outside, a node that moved is a vertex whatever is around it. Other zeros are as good as
    // `-`.
    if (rules.both_sides) brick.zero[kind] |= brick_part(lattice.warped[kind]);
  }
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) brick.cut[f] = brick_part(lattice.cut[f]);
  return brick;
}

BrickMask stuffed_cells(const WarpedLattice& lattice,
                        const PlusAround& plus,
                        const StuffingRules& rules) noexcept {
  BrickMask stuffed;
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    // The four tets around a face share both centres, so one of them is mixed if the six nodes
    // are.
    BrickMask any = plus.at(kCentre, {}), all = any;
    const auto add = [&](const BrickMask& node) {
      any |= node;
      all &= node;
    };
    add(plus.at(kCentre, face_step(direction)));
    for (int turn = 0; turn < 4; ++turn) add(plus.at(kCorner, face_turn(direction, turn)));
    stuffed |= any & ~all;
    if (!rules.both_sides) continue;
    // Unmoved zeros too: half pyramids take all their nodes to be on one side.
    const LatticeCoord step = direction < 3 ? LatticeCoord{} : face_step(direction);
    stuffed |= any_around_face(lattice.zero, direction % 3, step);
  }
  return stuffed;
}

FinestNodes gather_nodes(const BrickNeighbourhood& bricks, const HaloSet& leaf) noexcept {
  FinestNodes nodes;
  nodes.leaf = leaf;
  for (int o = 0; o < 8; ++o) {
    add_nodes(nodes, bricks[static_cast<std::size_t>(o)], o >> 2, o >> 1 & 1, o & 1);
  }
  return nodes;
}

FinestNodes seen_from_outside(const FinestNodes& inside) noexcept {
  FinestNodes outside = inside;
  outside.region = MeshRegion::kOutside;
  for (const NodeKind kind : {kCorner, kCentre}) {
    outside.plus[kind] = kKnownNodes - inside.plus[kind] - inside.zero[kind];
  }
  return outside;
}

NodeMasks finest_vertices(const StuffedBrick& brick, const LowerLeaves& leaves) noexcept {
  return {(brick.plus[kCorner] & leaf_corners(leaves)) | brick.zero[kCorner],
          (brick.plus[kCentre] & *leaves[0]) | brick.zero[kCentre]};
}

namespace {

/// Nodes and edges of the tets across one axis' faces; all of those faces carry four tets.
void mark_tets(const HaloSet& faces,
               int axis,
               std::array<HaloSet, kNodeKinds>& node,
               std::array<HaloSet, kEdgeFamilies>& edge) noexcept {
  for (const TetShape& shape : shapes_across(axis)) {
    for (std::size_t i = 0; i < 4; ++i) {
      node[shape.kind[i]] |= seen_from(faces, -shape.offset[i]);
    }
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      edge[shape.edge_family[e]] |= seen_from(faces, -shape.offset[kTetEdge[e][0]]);
    }
  }
}

void mark_half_pyramids(const FinestNodes& nodes,
                        std::array<HaloSet, kNodeKinds>& node) noexcept {
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const HaloSet cells = cells_with_half_pyramids(nodes, kCellsAround, direction);
    if (!cells.any()) continue;
    node[kCentre] |= cells;
    for (int turn = 0; turn < 4; ++turn) {
      const LatticeCoord at = face_turn(direction, turn);
      node[kCorner] |= seen_from(cells, -offset_index(at.x, at.y, at.z));
    }
  }
}

}  // namespace

namespace {

/// Reads the signs of a brick's own nodes, or of the nodes that lie a step on from them.
class SignsBeside {
 public:
  explicit SignsBeside(const BrickSurroundings& bricks) noexcept : bricks_(bricks) {}

  /// `signs` are StuffedBrick's plus or zero; each of `step` is -1, 0 or 1.
  BrickMask from(NodeMasks StuffedBrick::*signs,
                 NodeKind kind,
                 LatticeCoord step) const noexcept {
    const auto shifted = [](int axis, int by, const auto& at) {
      if (by == 0) return at(0);
      return by > 0 ? next_along(axis, at(0), at(1)) : previous_along(axis, at(0), at(-1));
    };
    return shifted(0, step.x, [&](int x) {
      return shifted(1, step.y, [&](int y) {
        return shifted(2, step.z, [&](int z) { return (brick(x, y, z).*signs)[kind]; });
      });
    });
  }

 private:
  /// No edge is cut that leads to a brick the surface does not reach, whichever side it is on:
  /// as if all its nodes were zeros.
  const StuffedBrick& brick(int x, int y, int z) const noexcept {
    static constexpr StuffedBrick kUnreached{{}, {BrickMask::all(), BrickMask::all()}, {}};
    const StuffedBrick* brick =
        bricks_[static_cast<std::size_t>(9 * (x + 1) + 3 * (y + 1) + z + 1)];
    return brick != nullptr ? *brick : kUnreached;
  }

  const BrickSurroundings& bricks_;
};

}  // namespace

TET_VECTOR_CLONES
std::array<BrickMask, kEdgeFamilies> edges_cut(const BrickSurroundings& bricks) noexcept {
  const SignsBeside signs(bricks);
  const StuffedBrick& own = *bricks[13];
  std::array<BrickMask, kEdgeFamilies> cut;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const LatticeCoord step = end_step(kind, family_direction(family));
    const BrickMask& plus = own.plus[kind];
    const BrickMask end_plus = signs.from(&StuffedBrick::plus, end, step);
    const BrickMask zero = own.zero[kind] | signs.from(&StuffedBrick::zero, end, step);
    cut[static_cast<std::size_t>(family)] = ((plus & ~end_plus) | (end_plus & ~plus)) & ~zero;
  }
  return cut;
}

UsedByTets used_by_tets(const BrickSurroundings& bricks, const HaloSet& leaf) noexcept {
  FinestNodes nodes;
  nodes.leaf = leaf;
  add_surroundings(nodes, bricks);
  std::array<HaloSet, kNodeKinds> node;
  std::array<HaloSet, kEdgeFamilies> edge;
  for (int axis = 0; axis < 3; ++axis) {
    mark_tets(leaf & seen_from(leaf, face_offset(axis)) & kCellsAround, axis, node, edge);
  }
  mark_half_pyramids(nodes, node);
  mark_half_pyramids(seen_from_outside(nodes), node);
  UsedByTets used;
  for (const NodeKind kind : {kCorner, kCentre}) used.node[kind] = brick_part(node[kind]);
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) used.edge[f] = brick_part(edge[f]);
  return used;
}

FaceSigns signs_around_faces(const FinestNodes& nodes,
                             int axis,
                             const HaloSet& cells) noexcept {
  FaceSigns faces;
  faces.region = nodes.region;
  const int across = face_offset(axis);
  faces.tets = nodes.leaf & seen_from(nodes.leaf, across) & cells;
  faces.plus[0] = nodes.plus[kCentre];
  faces.zero[0] = nodes.zero[kCentre];
  faces.plus[1] = seen_from(nodes.plus[kCentre], across);
  faces.zero[1] = seen_from(nodes.zero[kCentre], across);
  for (int turn = 0; turn < 4; ++turn) {
    const LatticeCoord at = face_turn(axis, turn);
    const int offset = offset_index(at.x, at.y, at.z);
    const auto node = static_cast<std::size_t>(2 + turn);
    faces.plus[node] = seen_from(nodes.plus[kCorner], offset);
    faces.zero[node] = seen_from(nodes.zero[kCorner], offset);
  }
  return faces;
}

ShapeSigns signs_of_shape(const FaceSigns& faces, const TetShape& shape) noexcept {
  ShapeSigns signs;
  signs.region = faces.region;
  for (std::size_t i = 0; i < 4; ++i) {
    signs.plus[i] = &faces.plus[shape.face_node[i]];
    signs.zero[i] = &faces.zero[shape.face_node[i]];
  }
  const auto& [p0, p1, p2, p3] = signs.plus;
  const auto& [z0, z1, z2, z3] = signs.zero;
  const std::uint64_t keeps_zeros =
      faces.region == MeshRegion::kOutside ? ~std::uint64_t{0} : 0;
  for (std::size_t w = 0; w < HaloSet::kWords; ++w) {
    const std::uint64_t tets = faces.tets.word[w];
    const std::uint64_t any_plus = p0->word[w] | p1->word[w] | p2->word[w] | p3->word[w];
    const std::uint64_t no_minus = (p0->word[w] | z0->word[w]) & (p1->word[w] | z1->word[w]) &
                                   (p2->word[w] | z2->word[w]) & (p3->word[w] | z3->word[w]);
    signs.whole.word[w] = tets & (any_plus | keeps_zeros) & no_minus;
    signs.regular.word[w] = tets & p0->word[w] & p1->word[w] & p2->word[w] & p3->word[w];
    signs.cut.word[w] = tets & any_plus & ~no_minus;
  }
  return signs;
}

HaloSet cells_with_half_pyramids(const FinestNodes& nodes,
                                 const HaloSet& own,
                                 int direction) noexcept {
  HaloSet cells = (nodes.leaf & own) - seen_from(nodes.leaf, face_offset(direction));
  cells &= nodes.plus[kCentre];
  // Towards a larger leaf they are all alike; not where the surface leaves the domain.
  for (int turn = 0; turn < 4 && cells.any(); ++turn) {
    const LatticeCoord at = face_turn(direction, turn);
    cells &= seen_from(nodes.plus[kCorner], offset_index(at.x, at.y, at.z));
  }
  return cells;
}

}  // namespace tet
