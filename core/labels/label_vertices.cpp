#include "core/labels/label_vertices.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "core/lattice/background.h"
#include "core/lattice/reach.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/local_places.h"

namespace tet {
namespace {

constexpr std::array<LabelShapeSlots, kTetShapes> make_shape_slots() {
  std::array<LabelShapeSlots, kTetShapes> shapes;
  for (std::size_t number = 0; number < kTetShapes; ++number) {
    const TetShape& shape = kTetShape[number];
    LabelShapeSlots& slots = shapes[number];
    std::array<int, 4> node{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto o = static_cast<int>(node_around_cell(shape, i));
      node[i] = node_slot(o >> 2, o >> 1 & 1, o & 1);
      slots.corner[i] = shape.kind[i] * kSlotsOfKind + node[i];
      slots.whole[i] = static_cast<Slot>(slots.corner[i]);
    }
    if (shape.negative) std::swap(slots.whole[2], slots.whole[3]);
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      slots.corner[4 + e] = edge_key(shape.edge_family[e], node[kTetEdge[e][0]]);
    }
    for (std::size_t i = 0; i < kTetFaces; ++i) {
      slots.corner[label_triple(i)] =
          kFirstTripleSlot + kFaceOfShape[number][i] * kSlotsOfKind + node[nodes_of_face(i)[0]];
    }
  }
  return shapes;
}

/// Whether three are different, jokers among them.
bool has_three(const std::array<Label, 4>& label) noexcept {
  const Label first = label[0];
  Label second = first;
  for (const Label l : label) {
    if (l == first || l == second) continue;
    if (second != first) return true;
    second = l;
  }
  return false;
}

/// Twice the coordinates of the node of a kind at a place within the brick.
LatticeCoord doubled(NodeKind kind, int x, int y, int z) noexcept {
  return {2 * x + kind, 2 * y + kind, 2 * z + kind};
}

}  // namespace

constinit const std::array<LabelShapeSlots, kTetShapes> kLabelShapeSlots = make_shape_slots();

std::uint64_t LabelledPart::count() const noexcept {
  if (node[kCorner] == nullptr) return 0;
  return std::uint64_t{node[kCorner]->count()} + node[kCentre]->count() +
         (brick != nullptr ? brick->other_vertices() : 0);
}

LabelVertices::LabelVertices() noexcept {
  std::ranges::copy(kLatticePoints, point_.begin());
  label_.fill(0);
  fraction_.fill(0);
  triple_.fill({});
  middle_.fill(LabelMiddle::kNone);
}

void LabelVertices::forget() noexcept {
  for (const Slot slot : std::span(moved_).first(moved_count_)) {
    point_[slot] = kLatticePoints[slot];
  }
  moved_count_ = 0;
  if (has_middles_) middle_.fill(LabelMiddle::kNone);
  has_triples_ = has_middles_ = false;
  jokers_.count = 0;
  others_.count = 0;
}

void LabelVertices::place(std::size_t slot, const WorldPoint& at) noexcept {
  point_[slot] = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
}

void LabelVertices::enter_labels(const LabelledPart& part, std::size_t o) noexcept {
  const auto [bx, by, bz] = UpperOffset(o);
  const int slices = bx == 1 ? 1 : 8, rows = by == 1 ? 1 : 8;
  const std::size_t nodes = bz == 1 ? 1 : 8;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int x = 0; x < slices; ++x) {
      for (int y = 0; y < rows; ++y) {
        Label* const row =
            label_.data() + kind * kSlotsOfKind + node_slot(x + 8 * bx, y + 8 * by, 8 * bz);
        if (part.brick == nullptr) {
          std::fill_n(row, nodes, part.one);
        } else {
          std::copy_n(part.brick->label[kind].data() + (x * 8 + y) * 8, nodes, row);
        }
      }
    }
  }
}

void LabelVertices::enter_jokers(const LabelledBrick& brick, std::size_t o) noexcept {
  std::size_t first = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    first +=
        for_each_in_reach(brick.joker[kind], o, [&](int x, int y, int z, std::size_t rank) {
          const Joker& joker = brick.jokers[first + rank];
          const auto node = static_cast<std::size_t>(kind * kSlotsOfKind + node_slot(x, y, z));
          const LocalPoint& at = kLatticePoints[node];
          const auto& [start, along] = kSlides[joker.direction];
          // Lattice places and steps are exact in float, their sums in double.
          const LocalPoint from{at.x + start.x, at.y + start.y, at.z + start.z};
          const LocalPoint step{joker.fraction * along.x, joker.fraction * along.y,
                                joker.fraction * along.z};
          point_[node] = {from.x + step.x, from.y + step.y, from.z + step.z};
          if (o == 0) jokers_.add(from, step);
          vote_[node] = {joker.own, joker.other};
          moved_[moved_count_++] = static_cast<Slot>(node);
        });
  }
}

template <class Index>
Index LabelVertices::enter_cuts(const LabelledBrick& brick,
                                std::size_t o,
                                Index next,
                                Index* ids) noexcept {
  std::size_t first = 0;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const std::size_t cuts = for_each_in_reach(
        brick.cut[static_cast<std::size_t>(family)], o,
        [&](int x, int y, int z, std::size_t rank) {
          const int low = node_slot(x, y, z);
          const auto slot = static_cast<std::size_t>(edge_key(family, low));
          const float fraction = brick.cut_fractions[first + rank];
          fraction_[slot - kFirstCutSlot] = fraction;
          ids[slot] = next + static_cast<Index>(rank);
          const LocalPoint& from =
              kLatticePoints[static_cast<std::size_t>(kind * kSlotsOfKind + low)];
          const LocalPoint& along =
              kSlides[static_cast<std::size_t>(family_direction(family))].along;
          const LocalPoint step{fraction * along.x, fraction * along.y, fraction * along.z};
          point_[slot] = {from.x + step.x, from.y + step.y, from.z + step.z};
          if (o != 0) return;
          others_.add({double{from.x} + double{step.x}, double{from.y} + double{step.y},
                       double{from.z} + double{step.z}});
        });
    first += cuts;
    next += static_cast<Index>(cuts);
  }
  return next;
}

template <class Index>
Index LabelVertices::enter_triples(const LabelledBrick& brick,
                                   std::size_t o,
                                   Index next,
                                   Index* ids) noexcept {
  if (brick.triple == nullptr) return next;
  has_triples_ = true;
  std::size_t first = 0;
  for (std::size_t family = 0; family < kFaceFamilies; ++family) {
    const FaceFamily& face = kFaceFamily[family];
    const std::size_t triples = for_each_in_reach(
        (*brick.triple)[family], o, [&](int x, int y, int z, std::size_t rank) {
          const FacePoint& point = brick.triple_points[first + rank];
          const LatticeCoord low = doubled(face.kind[0], x, y, z);
          const WorldPoint at =
              place_on_face({low, low + face.step[1], low + face.step[2]}, point);
          const std::size_t number =
              family * kSlotsOfKind + static_cast<std::size_t>(node_slot(x, y, z));
          const std::size_t slot = static_cast<std::size_t>(kFirstTripleSlot) + number;
          triple_[number] = point;
          ids[slot] = next + static_cast<Index>(rank);
          place(slot, at);
          if (o == 0) others_.add(at);
        });
    first += triples;
    next += static_cast<Index>(triples);
  }
  return next;
}

template <class Index>
void LabelVertices::enter_middles(const LabelledPart& own, LabelIds<Index>& ids) noexcept {
  if (own.brick == nullptr || own.brick->middle == nullptr) return;
  auto next =
      static_cast<Index>(own.first + own.node[kCorner]->count() + own.node[kCentre]->count() +
                         own.brick->cut_fractions.size() + own.brick->triple_points.size());
  has_middles_ = true;
  const LabelMiddle* kind = own.brick->middles.data();
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    for_each_bit((*own.brick->middle)[shape], [&](int x, int y, int z) {
      const LabelledTet of = tet(shape, node_slot(x, y, z));
      const WorldPoint at = LabelPlaces(of, doubled(kCorner, x, y, z)).middle(*kind);
      const auto slot = static_cast<std::size_t>(label_middle_slot(shape, x, 8 * y + z));
      middle_[slot - kFirstMiddleSlot] = *kind++;
      ids[slot] = next++;
      place(slot, at);
      others_.add(at);
    });
  }
}

template <class Index>
void LabelVertices::enter(const LabelledParts& parts, LabelIds<Index>& ids) noexcept {
  forget();
  for (std::size_t o = 0; o < parts.size(); ++o) {
    const LabelledPart& part = parts[o];
    if (part.node[kCorner] == nullptr) continue;
    auto next = static_cast<Index>(part.first);
    for (const NodeKind kind : {kCorner, kCentre}) {
      next = number_nodes(*part.node[kind], o, next, ids.data() + kind * kSlotsOfKind);
    }
    // A brick of one label has tets of that label alone.
    if (parts[0].brick != nullptr) enter_labels(part, o);
    if (part.brick == nullptr) continue;
    enter_jokers(*part.brick, o);
    next = enter_cuts(*part.brick, o, next, ids.data());
    enter_triples(*part.brick, o, next, ids.data());
  }
  enter_middles(parts[0], ids);
}

template void LabelVertices::enter(const LabelledParts&, LabelIds<std::uint32_t>&) noexcept;
template void LabelVertices::enter(const LabelledParts&, LabelIds<std::uint64_t>&) noexcept;

LabelledTet LabelVertices::tet(std::size_t shape, int cell) const noexcept {
  const LabelShapeSlots& slots = kLabelShapeSlots[shape];
  LabelledTet tet{kTetShape[shape]};
  for (std::size_t i = 0; i < 4; ++i) {
    tet.label[i] = label_[static_cast<std::size_t>(slots.corner[i] + cell)];
  }
  // Where an edge has no cut point, or a face no triple point, they are anything, and are not
  // looked at.
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    tet.fraction[e] =
        fraction_[static_cast<std::size_t>(slots.corner[4 + e] + cell - kFirstCutSlot)];
  }
  if (!has_triples_ || !has_three(tet.label)) return tet;
  for (std::size_t i = 0; i < kTetFaces; ++i) {
    tet.triple[i] = triple_[static_cast<std::size_t>(slots.corner[label_triple(i)] + cell -
                                                     kFirstTripleSlot)];
  }
  return tet;
}

JokerVotes LabelVertices::votes(std::size_t shape, int cell) const noexcept {
  JokerVotes votes;
  for (std::size_t i = 0; i < 4; ++i) {
    votes[i] = vote_[static_cast<std::size_t>(kLabelShapeSlots[shape].corner[i] + cell)];
  }
  return votes;
}

}  // namespace tet
