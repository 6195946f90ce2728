#include "core/stuffing/cell_nodes.h"

#include <cstdint>

#include "core/base/brick_index.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// The node of each cell that is (o >> 2, o >> 1 & 1, o & 1) away, for the eight o; `bricks` at
/// the same places.
TET_VECTOR_CLONES
void gather_around_cells(const std::array<const BrickMask*, 8>& bricks,
                         CellNodes::AroundCells& around) noexcept {
  std::array<BrickMask, 8> brick, next_z;
  for (std::size_t o = 0; o < 8; ++o) brick[o] = *bricks[o];
  for (std::size_t o = 0; o < 8; o += 2) next_z[o] = next_along(2, brick[o], brick[o + 1]);
  for (std::size_t o = 0; o < 8; o += 4) {
    brick[o + 2] = next_along(1, brick[o], brick[o + 2]);
    next_z[o + 2] = next_along(1, next_z[o], next_z[o + 2]);
  }
  for (std::size_t o = 0; o < 4; o += 2) {
    around[o] = brick[o];
    around[o + 1] = next_z[o];
    around[o + 4] = next_along(0, brick[o], brick[o + 4]);
    around[o + 5] = next_along(0, next_z[o], next_z[o + 4]);
  }
}

}  // namespace

LeavesAround leaves_around(const MaskColumn& leaf, const PlacesAround& places) noexcept {
  static constexpr BrickMask kNone;
  constexpr std::array<std::size_t, kFaceDirections> kBeyond{
      kItself + 9, kItself + 3, kItself + 1, kItself - 9, kItself - 3, kItself - 1};
  LeavesAround leaves{&leaf[places[kItself]], {}};
  for (std::size_t direction = 0; direction < kBeyond.size(); ++direction) {
    const std::uint32_t at = places[kBeyond[direction]];
    leaves.beyond[direction] = at != kNoBrick ? &leaf[at] : &kNone;
  }
  return leaves;
}

CellNodes nodes_around_cells(const BrickNeighbourhood& bricks,
                             const LeavesAround& leaves) noexcept {
  static constexpr BrickMask kNone;
  CellNodes nodes;
  for (const NodeKind kind : {kCorner, kCentre}) {
    std::array<const BrickMask*, 8> plus, zero;
    for (std::size_t o = 0; o < 8; ++o) {
      plus[o] = bricks[o] != nullptr ? &bricks[o]->plus[kind] : &kNone;
      zero[o] = bricks[o] != nullptr ? &bricks[o]->zero[kind] : &kNone;
    }
    gather_around_cells(plus, nodes.plus[kind]);
    gather_around_cells(zero, nodes.zero[kind]);
  }
  for (std::size_t direction = 0; direction < kFaceDirections; ++direction) {
    const int axis = static_cast<int>(direction) % 3;
    const BrickMask& beyond = *leaves.beyond[direction];
    const BrickMask across = direction < 3 ? next_along(axis, *leaves.own, beyond)
                                           : previous_along(axis, *leaves.own, beyond);
    nodes.ends[direction] = *leaves.own & ~across;
    if (direction < 3) nodes.pairs[direction] = *leaves.own & across;
  }
  return nodes;
}

void see_from_outside(CellNodes& nodes) noexcept {
  nodes.region = MeshRegion::kOutside;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (std::size_t o = 0; o < 8; ++o) {
      nodes.plus[kind][o] = ~(nodes.plus[kind][o] | nodes.zero[kind][o]);
    }
  }
}

TET_VECTOR_CLONES
ShapeTets tets_of_shape(const CellNodes& nodes, std::size_t number) noexcept {
  const TetShape& shape = kTetShape[number];
  std::array<const BrickMask*, 4> plus, zero;
  for (std::size_t i = 0; i < 4; ++i) {
    plus[i] = &nodes.plus[shape.kind[i]][node_around_cell(shape, i)];
    zero[i] = &nodes.zero[shape.kind[i]][node_around_cell(shape, i)];
  }
  const auto& [p0, p1, p2, p3] = plus;
  const auto& [z0, z1, z2, z3] = zero;
  const BrickMask& pairs = nodes.pairs[number / 4];
  const std::uint64_t keeps_zeros =
      nodes.region == MeshRegion::kOutside ? ~std::uint64_t{0} : 0;
  ShapeTets tets;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t any_plus = p0->slice[x] | p1->slice[x] | p2->slice[x] | p3->slice[x];
    const std::uint64_t all_plus = p0->slice[x] & p1->slice[x] & p2->slice[x] & p3->slice[x];
    const std::uint64_t no_minus =
        (p0->slice[x] | z0->slice[x]) & (p1->slice[x] | z1->slice[x]) &
        (p2->slice[x] | z2->slice[x]) & (p3->slice[x] | z3->slice[x]);
    tets.whole.slice[x] = pairs.slice[x] & (any_plus | keeps_zeros) & no_minus;
    tets.regular.slice[x] = pairs.slice[x] & all_plus;
    tets.cut.slice[x] = pairs.slice[x] & any_plus & ~no_minus;
  }
  return tets;
}

BrickMask half_pyramids_of_finest(const CellNodes& nodes, int direction) noexcept {
  BrickMask cells = nodes.ends[static_cast<std::size_t>(direction)] & nodes.plus[kCentre][0];
  // Towards a larger leaf they are all alike; not where the surface leaves the domain.
  for (int turn = 0; turn < 4 && cells.any(); ++turn) {
    const LatticeCoord at = face_turn(direction, turn);
    cells &= nodes.plus[kCorner][static_cast<std::size_t>(at.x * 4 + at.y * 2 + at.z)];
  }
  return cells;
}

}  // namespace tet
