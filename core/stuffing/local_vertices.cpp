#include "core/stuffing/local_vertices.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>

#include "core/base/vector_clones.h"
#include "core/lattice/background.h"
#include "core/lattice/node_numbers.h"
#include "core/lattice/reach.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/local_places.h"

namespace tet {

std::uint64_t OwnedVertices::count() const noexcept {
  if (node[kCorner] == nullptr) return 0;
  std::uint64_t vertices = node[kCorner]->count() + node[kCentre]->count();
  if (stuffed != nullptr) {
    for (const BrickMask& mask : stuffed->cut) vertices += mask.count();
  }
  if (fans != nullptr) {
    for (const BrickMask& mask : *fans) vertices += mask.count();
  }
  return vertices;
}

void OwnPlaces::add(const LocalPoint& from, const LocalPoint& step) noexcept {
  x[count] = double{from.x} + double{step.x};
  y[count] = double{from.y} + double{step.y};
  z[count++] = double{from.z} + double{step.z};
}

LocalVertices::LocalVertices() noexcept {
  std::copy(kLatticePoints.begin(), kLatticePoints.end(), point_.begin());
  std::iota(slot_.begin(), slot_.begin() + kFirstCutSlot, Slot{0});
  std::fill(slot_.begin() + kFirstCutSlot, slot_.end(), Slot{kFirstCutSlot});
  fraction_.fill(0);
}

void LocalVertices::forget() noexcept {
  for (const Slot slot : std::span(moved_).first(moved_count_)) {
    point_[slot] = kLatticePoints[slot];
  }
  moved_count_ = 0;
  own_.count = 0;
  next_slot_ = kFirstCutSlot;
}

/// Where a vertex lies: at a fraction of the edge from `node` in a direction. Also put into
/// `own`, where that is not null.
inline LocalPoint LocalVertices::place(int node,
                                       int direction,
                                       float fraction,
                                       OwnPlaces* own) noexcept {
  const LocalPoint& at = kLatticePoints[static_cast<std::size_t>(node)];
  const auto& [start, along] = kSlides[static_cast<std::size_t>(direction)];
  // Lattice places and steps are exact in float, their sums in double.
  const LocalPoint from{at.x + start.x, at.y + start.y, at.z + start.z};
  const LocalPoint step{fraction * along.x, fraction * along.y, fraction * along.z};
  if (own != nullptr) own->add(from, step);
  return {from.x + step.x, from.y + step.y, from.z + step.z};
}

TET_VECTOR_CLONES
void LocalVertices::enter_zeros(const OwnedVertices& from,
                                const PackedGeometry& packed,
                                std::size_t o) noexcept {
  OwnPlaces* const own = o == 0 ? &own_ : nullptr;
  std::size_t first = 0, moved_count = moved_count_;
  for (const NodeKind kind : {kCorner, kCentre}) {
    first += for_each_in_reach(
        from.stuffed->zero[kind], o, [&](int x, int y, int z, std::size_t rank) {
          const int node = kind * kSlotsOfKind + node_slot(x, y, z);
          const std::uint8_t direction = packed.direction(first + rank);
          const bool moved = direction != kUnmoved;
          const float fraction = moved ? packed.fraction(first + rank) : 0;
          point_[static_cast<std::size_t>(node)] =
              place(node, moved ? direction : 0, fraction, own);
          moved_[moved_count++] = static_cast<Slot>(node);
        });
  }
  moved_count_ = moved_count;
}

template <class Index>
TET_VECTOR_CLONES void LocalVertices::enter_cuts(const OwnedVertices& from,
                                                 const PackedGeometry& packed,
                                                 std::size_t o,
                                                 Index next,
                                                 SlotIds<Index>& ids) noexcept {
  OwnPlaces* const own = o == 0 ? &own_ : nullptr;
  std::size_t first = packed.zeros(), slot = next_slot_;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const int nodes = family_kind(family) * kSlotsOfKind;
    const std::size_t cuts = for_each_in_reach(
        from.stuffed->cut[static_cast<std::size_t>(family)], o,
        [&](int x, int y, int z, std::size_t rank) {
          const int low = node_slot(x, y, z);
          const float fraction = packed.fraction(first + rank);
          slot_[static_cast<std::size_t>(edge_key(family, low))] = static_cast<Slot>(slot);
          fraction_[slot - kFirstCutSlot] = fraction;
          ids[slot] = next + static_cast<Index>(rank);
          point_[slot++] = place(nodes + low, family_direction(family), fraction, own);
        });
    first += cuts;
    next += static_cast<Index>(cuts);
  }
  next_slot_ = static_cast<Slot>(slot);
}

/// The mean of the cut points of a tet that has a quad.
WorldPoint LocalVertices::middle_of_quad(
    const VerticesAround& around, const TetShape& shape, int x, int y, int z) const noexcept {
  WorldPoint sum;
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    const Cell low(halo_index(x, y, z) + shape.offset[kTetEdge[e][0]]);
    const int family = shape.edge_family[e];
    const auto brick =
        static_cast<std::size_t>((low.x >> 3) * 4 + (low.y >> 3) * 2 + (low.z >> 3));
    const StuffedBrick* const stuffed = around[brick].stuffed;
    if (stuffed == nullptr ||
        !stuffed->cut[static_cast<std::size_t>(family)].test(low.x & 7, low.y & 7, low.z & 7)) {
      continue;
    }
    const NodeKind kind = family_kind(family);
    const WorldPoint cut = place_on_edge(
        {2 * low.x + kind, 2 * low.y + kind, 2 * low.z + kind}, family_direction(family),
        fraction(slot(edge_key(family, node_slot(low.x, low.y, low.z)))));
    sum = {sum.x + cut.x, sum.y + cut.y, sum.z + cut.z};
  }
  return {0.25 * sum.x, 0.25 * sum.y, 0.25 * sum.z};
}

template <class Index>
void LocalVertices::enter_fans(const VerticesAround& around, SlotIds<Index>& ids) noexcept {
  const OwnedVertices& own = around[0];
  if (own.fans == nullptr) return;
  const Slot end_of_cuts = next_slot_;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    first_fan_[shape] = next_slot_;
    fan_[shape] = &(*own.fans)[shape];
    for_each_bit((*own.fans)[shape], [&](int x, int y, int z) {
      const WorldPoint place = middle_of_quad(around, kTetShape[shape], x, y, z);
      own_.add(place);
      point_[next_slot_++] = {static_cast<float>(place.x), static_cast<float>(place.y),
                              static_cast<float>(place.z)};
    });
  }
  const std::uint64_t first = own.first + own.count() - (next_slot_ - end_of_cuts);
  for (Slot slot = end_of_cuts; slot < next_slot_; ++slot) {
    ids[slot] = static_cast<Index>(first + (slot - end_of_cuts));
  }
}

/// Whether a brick's tets reach any zero or cut point of the neighbour at `o`. Of most bricks
/// beyond an edge they reach none, and what nobody reaches need not be counted.
[[gnu::always_inline]] inline bool any_in_reach(const StuffedBrick& brick,
                                                std::size_t o) noexcept {
  const auto [bx, by, bz] = UpperOffset(o);
  BrickMask any = brick.zero[kCorner] | brick.zero[kCentre];
  for (const BrickMask& cut : brick.cut) any |= cut;
  std::uint64_t bits = any.slice[0];
  for (std::size_t x = 1; x < 8; ++x) bits |= bx == 1 ? 0 : any.slice[x];
  return (bits & reachable_bits(by, bz)) != 0;
}

template <class Index>
TET_VECTOR_CLONES void LocalVertices::enter(const VerticesAround& around,
                                            SlotIds<Index>& ids) noexcept {
  forget();
  for (std::size_t o = 0; o < around.size(); ++o) {
    const OwnedVertices& from = around[o];
    if (from.node[kCorner] == nullptr) continue;
    auto next = static_cast<Index>(from.first);
    for (const NodeKind kind : {kCorner, kCentre}) {
      next = number_nodes(*from.node[kind], o, next, ids.data() + kind * kSlotsOfKind);
    }
    if (!from.at_surface || !any_in_reach(*from.stuffed, o)) continue;
    const PackedGeometry packed(from.geometry, *from.stuffed);
    enter_zeros(from, packed, o);
    enter_cuts(from, packed, o, next, ids);
  }
  enter_fans(around, ids);
}

Slot LocalVertices::fan_slot(std::size_t shape, int x, int bit) const noexcept {
  return static_cast<Slot>(first_fan_[shape] + rank_of(*fan_[shape], x, bit >> 3, bit & 7));
}

template void LocalVertices::enter(const VerticesAround&, SlotIds<std::uint32_t>&) noexcept;
template void LocalVertices::enter(const VerticesAround&, SlotIds<std::uint64_t>&) noexcept;

}  // namespace tet
