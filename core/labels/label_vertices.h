// The vertices that the tets of a finest brick of labels use, numbered within the brick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/base/local_point.h"
#include "core/labels/label.h"
#include "core/labels/label_tets.h"
#include "core/labels/labelled_brick.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// A finest brick, and what is known of it.
struct LabelledPart {
  std::array<const BrickMask*, kNodeKinds> node{};  ///< its vertices; null: no such brick
  const LabelledBrick* brick = nullptr;             ///< null: `one` fills it
  Label one = 0;
  std::uint64_t first = 0;  ///< id of its first vertex

  std::uint64_t count() const noexcept;
};

/// A brick and the seven beyond its upper faces, at 4*x + 2*y + z.
using LabelledParts = std::array<LabelledPart, 8>;

// Slots: the nodes [0, 8]^3, corners before centres; cut points by family and lower node;
// triple points by family and lowest node; middles by shape and cell. A slot is the same
// distance from that of the next cell for all but middles.
inline constexpr int kFirstTripleSlot = kFirstCutSlot + kEdgeFamilies * kSlotsOfKind;
inline constexpr int kFirstMiddleSlot = kFirstTripleSlot + kFaceFamilies * kSlotsOfKind;
inline constexpr int kLabelSlots = kFirstMiddleSlot + kTetShapes * kBrickCells;
static_assert(kLabelSlots <= 1 << 16);

template <class Index>
using LabelIds = std::array<Index, kLabelSlots>;

/// Where vertices lie, in spacings from the brick's lowest corner.
struct LabelOwnPlaces {
  static constexpr std::size_t kMax =
      std::size_t{kEdgeFamilies + kFaceFamilies + kTetShapes} * kBrickCells;
  std::array<double, kMax> x, y, z;
  std::size_t count = 0;

  void add(const WorldPoint& place) noexcept {
    x[count] = place.x;
    y[count] = place.y;
    z[count++] = place.z;
  }
};

class LabelVertices {
 public:
  LabelVertices() noexcept;

  /// Numbers the vertices of a brick and of those beyond its upper faces as far as its tets
  /// reach, and forgets the brick before.
  template <class Index>
  void enter(const LabelledParts& parts, LabelIds<Index>& ids) noexcept;

  /// By slot, in spacings from the brick's lowest corner.
  const LocalPoint* points() const noexcept { return point_.data(); }
  /// Where the brick's own jokers lie, in the order of nodes.
  const OwnPlaces& joker_places() const noexcept { return jokers_; }
  /// Where its other vertices lie that are no nodes, in the order of their ids.
  const LabelOwnPlaces& other_places() const noexcept { return others_; }

  /// By slot of a node; kJoker where it moved. Rows of eight may be read from any cell's.
  const Label* labels() const noexcept { return label_.data(); }

  /// The tet of a shape in a cell, by its slot.
  LabelledTet tet(std::size_t shape, int cell) const noexcept;
  /// What was found of the middle of the tet of a shape in the cell at a bit of a slice.
  LabelMiddle middle(std::size_t shape, int x, int bit) const noexcept {
    return middle_[shape * kBrickCells + static_cast<std::size_t>(x * 64 + bit)];
  }
  JokerVotes votes(std::size_t shape, int cell) const noexcept;

 private:
  void forget() noexcept;
  void enter_labels(const LabelledPart& part, std::size_t o) noexcept;
  void enter_jokers(const LabelledBrick& brick, std::size_t o) noexcept;
  template <class Index>
  Index enter_cuts(const LabelledBrick& brick, std::size_t o, Index next, Index* ids) noexcept;
  template <class Index>
  Index enter_triples(const LabelledBrick& brick,
                      std::size_t o,
                      Index next,
                      Index* ids) noexcept;
  template <class Index>
  void enter_middles(const LabelledPart& own, LabelIds<Index>& ids) noexcept;
  void place(std::size_t slot, const WorldPoint& at) noexcept;

  std::array<LocalPoint, kLabelSlots> point_;
  std::array<Label, kFirstCutSlot> label_;
  std::array<float, kMaxCutSlots> fraction_;
  std::array<FacePoint, std::size_t{kFaceFamilies} * kSlotsOfKind> triple_;
  std::array<LabelMiddle, std::size_t{kTetShapes} * kBrickCells> middle_;
  bool has_triples_ = false, has_middles_ = false;
  std::array<std::array<Label, 2>, kFirstCutSlot> vote_;
  std::array<Slot, kFirstCutSlot> moved_;  // nodes, to be put back
  std::size_t moved_count_ = 0;
  OwnPlaces jokers_;
  LabelOwnPlaces others_;
};

/// Where a shape's corners are found, from the slot of the cell that the tet belongs to; but
/// for its middle.
struct LabelShapeSlots {
  std::array<int, kLabelMiddle> corner{};
  LocalTet whole{};  ///< the nodes in the order of a positive tet
};
extern const std::array<LabelShapeSlots, kTetShapes> kLabelShapeSlots;

constexpr int label_middle_slot(std::size_t shape, int x, int bit) noexcept {
  return kFirstMiddleSlot + static_cast<int>(shape) * kBrickCells + x * 64 + bit;
}

}  // namespace tet
