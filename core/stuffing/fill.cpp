#include "core/stuffing/fill.h"

#include <bit>
#include <utility>

#include "core/stuffing/cut_tet.h"
#include "core/stuffing/write_rows.h"

namespace tet {
namespace {

/// The slots of a shape's nodes, from those of the cell it belongs to.
std::array<int, 4> node_slots(const TetShape& shape) noexcept {
  std::array<int, 4> slot;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto o = static_cast<int>(node_around_cell(shape, i));
    slot[i] = shape.kind[i] * kSlotsOfKind + node_slot(o >> 2, o >> 1 & 1, o & 1);
  }
  return slot;
}

/// Tets without cut nodes, in the order that makes them positive.
std::array<int, 4> whole_tet(const TetShape& shape) noexcept {
  std::array<int, 4> slot = node_slots(shape);
  if (shape.negative) std::swap(slot[2], slot[3]);
  return slot;
}

void add_moved(const TetShape& shape, const BrickMask& moved, StuffedTets& out) noexcept {
  const std::array<int, 4> first = whole_tet(shape);
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t bits = moved.slice[static_cast<std::size_t>(x)]; bits != 0;
         bits &= bits - 1) {
      const int cell = cell_slot(x, std::countr_zero(bits));
      out.add({static_cast<Slot>(first[0] + cell), static_cast<Slot>(first[1] + cell),
               static_cast<Slot>(first[2] + cell), static_cast<Slot>(first[3] + cell)});
    }
  }
}

/// Makes the tets that stand for cut ones of one shape.
class CutShape {
 public:
  CutShape(const FinestBrick& brick, std::size_t number) noexcept
      : brick_(brick), number_(number), shape_(kTetShape[number]), node_(node_slots(shape_)) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t o = node_around_cell(shape_, i);
      plus_[i] = &brick.nodes.plus[shape_.kind[i]][o];
      zero_[i] = &brick.nodes.zero[shape_.kind[i]][o];
    }
  }

  /// Adds those of the tet in the cell at a bit of a slice.
  void add(int x, int bit, StuffedTets& out) const noexcept {
    std::array<Slot, kStencilVertices> slot;
    EdgeFractions fraction;
    find_corners(x, bit, slot, fraction);
    const CutTet cut_tet(shape_, stencil_of(x, bit), fraction, brick_.nodes.region,
                         brick_.rules);
    if (cut_tet.has_fan()) slot[kQuadCentre] = brick_.vertices.fan_slot(number_, x, bit);
    for (auto [a, b, c, d] : cut_tet.tets()) {
      if (shape_.negative) std::swap(c, d);
      out.add({slot[a], slot[b], slot[c], slot[d]});
    }
  }

 private:
  std::size_t stencil_of(int x, int bit) const noexcept {
    const auto slice = static_cast<std::size_t>(x);
    std::size_t number = 0;
    for (std::size_t i = 4; i-- > 0;) {
      number = 3 * number + 2 * (plus_[i]->slice[slice] >> bit & 1) +
               (zero_[i]->slice[slice] >> bit & 1);
    }
    return number;
  }

  /// All four nodes and all six edges, cut or not: what is not there is not asked for.
  void find_corners(int x,
                    int bit,
                    std::array<Slot, kStencilVertices>& slot,
                    EdgeFractions& fraction) const noexcept {
    const int cell = cell_slot(x, bit);
    for (std::size_t i = 0; i < 4; ++i) slot[i] = static_cast<Slot>(node_[i] + cell);
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      const std::size_t low = kTetEdge[e][0];
      const int low_node = slot[low] - shape_.kind[low] * kSlotsOfKind;
      const Slot cut = brick_.vertices.cut_slot(shape_.edge_family[e], low_node);
      slot[cut_on_edge(e)] = cut;
      fraction[e] = brick_.vertices.fraction(cut);
    }
  }

  const FinestBrick& brick_;
  std::size_t number_;
  const TetShape& shape_;
  std::array<int, 4> node_;
  std::array<const BrickMask*, 4> plus_, zero_;
};

void add_cut(const FinestBrick& brick,
             std::size_t shape,
             const BrickMask& cut,
             StuffedTets& out) noexcept {
  const CutShape cut_shape(brick, shape);
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t bits = cut.slice[static_cast<std::size_t>(x)]; bits != 0;
         bits &= bits - 1) {
      cut_shape.add(x, std::countr_zero(bits), out);
    }
  }
}

template <class Index>
Index* write_local(std::span<const LocalTet> tets,
                   const SlotIds<Index>& ids,
                   Index* out) noexcept {
  for (const auto& [a, b, c, d] : tets) out = write_tet(out, ids[a], ids[b], ids[c], ids[d]);
  return out;
}

template <class Index>
Index* write_half_pyramids_of_finest(const CellNodes& nodes,
                                     const SlotIds<Index>& ids,
                                     Index* out,
                                     BackgroundCounts& counts) noexcept {
  const auto corner = [&](int x, int y, int z) {
    return ids[static_cast<std::size_t>(node_slot(x, y, z))];
  };
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const BrickMask cells = half_pyramids_of_finest(nodes, direction);
    counts.half_pyramid += 2 * std::uint64_t{cells.count()};
    for_each_bit(cells, [&](int x, int y, int z) {
      const Index centre = ids[static_cast<std::size_t>(kSlotsOfKind + node_slot(x, y, z))];
      out = write_half_pyramids(direction, Cell(halo_index(x, y, z)), centre, corner, out);
    });
  }
  return out;
}

}  // namespace

template <class Index>
Index* fill_finest(const FinestBrick& brick,
                   const SlotIds<Index>& ids,
                   Index* tets,
                   StuffedTets& stuffed,
                   BackgroundCounts& counts) noexcept {
  for (std::size_t number = 0; number < kTetShapes; ++number) {
    const TetShape& shape = kTetShape[number];
    const ShapeTets found = tets_of_shape(brick.nodes, number);
    tets = write_rows(found.whole, whole_tet(shape), ids.data(), tets);
    counts.bcc += found.regular.count();
    add_moved(shape, found.whole & ~found.regular, stuffed);
    const std::size_t first_cut = stuffed.count();
    add_cut(brick, number, found.cut, stuffed);
    tets = write_local(stuffed.from(first_cut), ids, tets);
  }
  return write_half_pyramids_of_finest(brick.nodes, ids, tets, counts);
}

template std::uint32_t* fill_finest(const FinestBrick&,
                                    const SlotIds<std::uint32_t>&,
                                    std::uint32_t*,
                                    StuffedTets&,
                                    BackgroundCounts&) noexcept;
template std::uint64_t* fill_finest(const FinestBrick&,
                                    const SlotIds<std::uint64_t>&,
                                    std::uint64_t*,
                                    StuffedTets&,
                                    BackgroundCounts&) noexcept;

}  // namespace tet
