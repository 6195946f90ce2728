// The vertices that a finest brick's tets use, numbered within the brick, so that tets can be
// made and measured from small tables.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/local_point.h"
#include "core/base/types.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

class PackedGeometry;

/// Vertices of one brick in the order of their ids, from `first` on: nodes of either kind, cut
/// points by family, middles of surface quads by shape.
struct OwnedVertices {
  std::array<const BrickMask*, kNodeKinds> node{};  ///< null: no such brick
  const StuffedBrick* stuffed = nullptr;            ///< null where every node is `-`
  bool at_surface = false;                          ///< something is zero or cut
  const std::byte* geometry = nullptr;              ///< packed, of a brick at the surface
  const FanMasks* fans = nullptr;                   ///< no other brick's tets have these
  std::uint64_t first = 0;

  std::uint64_t count() const noexcept;
};

/// A finest brick and the seven beyond its upper faces, at 4*x + 2*y + z.
using VerticesAround = std::array<OwnedVertices, 8>;

/// A vertex' number within the brick. First come the nodes [0, 8]^3, corners before centres and
/// vertices or not, then cut points, then middles of quads.
using Slot = std::uint16_t;
inline constexpr int kSlotsOfKind = 9 * 9 * 9;
inline constexpr int kFirstCutSlot = kNodeKinds * kSlotsOfKind;
inline constexpr int kMaxCutSlots = kEdgeFamilies * kSlotsOfKind;
inline constexpr int kSlots = kFirstCutSlot + kMaxCutSlots + kTetShapes * kBrickCells;
static_assert(kSlots <= 1 << 16);

/// A node's place among those of its kind; neighbours are a constant away.
constexpr int node_slot(int x, int y, int z) noexcept { return (x * 9 + y) * 9 + z; }
/// The place of a cell's lowest corner, or of its centre, where the cell is a bit of a mask's
/// slice.
constexpr int cell_slot(int x, int bit) noexcept { return x * 81 + bit + (bit >> 3); }

/// What a corner of a stencil is: a node is its own slot, a cut point is looked up by its edge.
/// Both are a constant away from those of the next cell.
constexpr int edge_key(int family, int low) noexcept {
  return kFirstCutSlot + family * kSlotsOfKind + low;
}
inline constexpr int kKeys = kFirstCutSlot + kMaxCutSlots;

/// Global ids by slot; anything where there is no vertex.
template <class Index>
using SlotIds = std::array<Index, kSlots>;

/// Where a brick's own vertices lie that are no plain lattice nodes, in spacings from its
/// lowest corner: zero corners (moved or not), zero centres, cut points, middles of quads, each
/// in the order of their ids.
struct OwnPlaces {
  static constexpr std::size_t kMax =
      std::size_t{kNodeKinds + kEdgeFamilies + kTetShapes} * kBrickCells;
  std::array<double, kMax> x, y, z;
  std::size_t count = 0;

  void add(const WorldPoint& place) noexcept {
    x[count] = place.x;
    y[count] = place.y;
    z[count++] = place.z;
  }
  /// Adds the place `from` + `step`.
  void add(const LocalPoint& from, const LocalPoint& step) noexcept;
};

/// The vertices of a brick.
class LocalVertices {
 public:
  LocalVertices() noexcept;

  /// Numbers the vertices of a brick and of those beyond its upper faces as far as its tets
  /// reach, and forgets the brick before.
  template <class Index>
  void enter(const VerticesAround& around, SlotIds<Index>& ids) noexcept;

  /// Where they lie, by slot, in spacings from the brick's lowest corner.
  const LocalPoint* points() const noexcept { return point_.data(); }

  const OwnPlaces& own_places() const noexcept { return own_; }

  /// The vertex at a node (its slot) or on an edge (its edge_key).
  Slot slot(int key) const noexcept { return slot_[static_cast<std::size_t>(key)]; }
  /// How far along its edge a cut point lies.
  float fraction(Slot cut) const noexcept {
    return fraction_[static_cast<std::size_t>(cut - kFirstCutSlot)];
  }
  /// The middle of the surface quad of a tet, by its cell.
  Slot fan_slot(std::size_t shape, int x, int bit) const noexcept;

 private:
  void forget() noexcept;
  static LocalPoint place(int node, int direction, float fraction, OwnPlaces* own) noexcept;
  void enter_zeros(const OwnedVertices& from,
                   const PackedGeometry& packed,
                   std::size_t o) noexcept;
  template <class Index>
  void enter_cuts(const OwnedVertices& from,
                  const PackedGeometry& packed,
                  std::size_t o,
                  Index next,
                  SlotIds<Index>& ids) noexcept;
  template <class Index>
  void enter_fans(const VerticesAround& around, SlotIds<Index>& ids) noexcept;
  WorldPoint middle_of_quad(
      const VerticesAround& around, const TetShape& shape, int x, int y, int z) const noexcept;

  std::array<LocalPoint, kSlots> point_;
  std::array<float, kMaxCutSlots> fraction_;
  std::array<Slot, kKeys> slot_;
  std::array<Slot, kFirstCutSlot> moved_;  // nodes, to be put back
  OwnPlaces own_;
  std::size_t moved_count_ = 0;
  Slot next_slot_ = kFirstCutSlot;
  std::array<const BrickMask*, kTetShapes> fan_{};
  std::array<Slot, kTetShapes> first_fan_{};
};

}  // namespace tet
