#include "core/stuffing/fill.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "core/base/vector_clones.h"
#include "core/stuffing/cut_tet.h"
#include "core/stuffing/surface_faces.h"
#include "core/stuffing/write_rows.h"

namespace tet {
namespace {

/// Where the corners of a shape's stencils are found among a brick's vertices: keys, from the
/// slot of the cell that the tet belongs to.
struct ShapeKeys {
  std::array<int, kStencilVertices> corner{};  ///< but for the middle of a quad
  LocalTet whole{};                            ///< the nodes in the order of a positive tet
};

constexpr auto kShapeKeys = [] {
  std::array<ShapeKeys, kTetShapes> shapes;
  for (std::size_t number = 0; number < kTetShapes; ++number) {
    const TetShape& shape = kTetShape[number];
    ShapeKeys& keys = shapes[number];
    std::array<int, 4> node{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto o = static_cast<int>(node_around_cell(shape, i));
      node[i] = node_slot(o >> 2, o >> 1 & 1, o & 1);
      keys.corner[i] = shape.kind[i] * kSlotsOfKind + node[i];
      keys.whole[i] = static_cast<Slot>(keys.corner[i]);
    }
    if (shape.negative) std::swap(keys.whole[2], keys.whole[3]);
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      keys.corner[cut_on_edge(e)] = edge_key(shape.edge_family[e], node[kTetEdge[e][0]]);
    }
  }
  return shapes;
}();

/// The tet with `first` in cell 0, moved on by `cells`: all four slots at once.
LocalTet moved_on(const LocalTet& first, int cells) noexcept {
  constexpr std::uint64_t kEach = 0x0001000100010001;
  return std::bit_cast<LocalTet>(std::bit_cast<std::uint64_t>(first) +
                                 static_cast<std::uint64_t>(cells) * kEach);
}

/// The corner of a written tet that was corner `i` before it was made positive.
std::size_t written_corner(const TetShape& shape, std::size_t i) noexcept {
  return shape.negative && i >= 2 ? 5 - i : i;
}

/// Calls `visit(tet, x, bit)` for some of the tets that are written whole, `first` the number
/// of the first of those; `some(x)` are those of a slice.
template <class Some, class Visit>
void for_each_of_whole(const BrickMask& whole,
                       const Some& some,
                       std::size_t first,
                       const Visit& visit) noexcept {
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = whole.slice[x];
    for (std::uint64_t bits = some(x); bits != 0; bits &= bits - 1) {
      const int before = std::popcount(slice & ((bits & -bits) - 1));
      visit(first + static_cast<std::size_t>(before), x, std::countr_zero(bits));
    }
    first += static_cast<std::size_t>(std::popcount(slice));
  }
}

/// The triangles of the surface on faces of a brick's whole tets.
class WholeOnSurface {
 public:
  explicit WholeOnSurface(const FinestBrick& brick) noexcept {
    if (brick.faces == nullptr || brick.nodes.region != MeshRegion::kInside) return;
    ThreeZeros three_zeros;
    find_three_zeros(brick.nodes, three_zeros);
    if (std::ranges::none_of(three_zeros, &BrickMask::any)) return;
    find_on_surface(three_zeros, brick.nodes, brick.faces->around, surface_.emplace());
  }
  /// Null where there are none.
  const TetsOnSurface* of_shape(std::size_t shape) const noexcept {
    return surface_ ? &(*surface_)[shape] : nullptr;
  }

 private:
  std::optional<SurfaceOfBrick> surface_;
};

/// Notes faces of tets that are written whole, `first` the number of the first of them.
void add_faces_of_whole(const FinestBrick& brick,
                        std::size_t shape,
                        const BrickMask& whole,
                        const TetsOnSurface* open,
                        std::size_t first) noexcept {
  const TetShape& of = kTetShape[shape];
  const FacesAround& around = brick.faces->around;
  LocalFaces& faces = brick.faces->faces;
  if (open != nullptr) {
    const LocalTet at_first = kShapeKeys[shape].whole;
    const auto tets = [&](std::size_t x) { return open->tets.slice[x]; };
    for_each_of_whole(whole, tets, first, [&](std::size_t tet, std::size_t x, int bit) {
      const LocalTet corners = moved_on(at_first, cell_slot(static_cast<int>(x), bit));
      faces.add_on_surface(tet, written_corner(of, open->plus_node(x, bit)), corners);
    });
  }
  if (around.domain == nullptr) return;
  const std::uint8_t label = label_of_direction(DomainFaces::direction_of(shape));
  const BrickMask near = whole & around.domain->near_dents(brick.nodes, shape);
  const auto tets = [&](std::size_t x) { return near.slice[x]; };
  for_each_of_whole(whole, tets, first, [&](std::size_t tet, std::size_t x, int bit) {
    const unsigned behind =
        around.domain->behind_dents(shape, static_cast<int>(x), bit >> 3, bit & 7);
    for (std::size_t k = 0; k < 4; ++k) {
      if ((behind >> k & 1) != 0) faces.add(tet, written_corner(of, k), label);
    }
  });
}

void add_moved(const LocalTet& first, const BrickMask& moved, StuffedTets& out) noexcept {
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t bits = moved.slice[static_cast<std::size_t>(x)]; bits != 0;
         bits &= bits - 1) {
      out.add(moved_on(first, cell_slot(x, std::countr_zero(bits))));
    }
  }
}

/// The zero nodes of each stencil's lattice tet, one bit each.
constexpr auto kZeroNodes = [] {
  std::array<std::uint8_t, kStencilCases> zeros{};
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    const auto& sorted = internal::kSortedNodes[number];
    for (std::size_t i = 0; i < sorted.zero_count; ++i) {
      zeros[number] = static_cast<std::uint8_t>(zeros[number] | 1U << sorted.zero[i]);
    }
  }
  return zeros;
}();

/// Makes the tets that stand for cut ones of one shape.
class CutShape {
 public:
  /// `tets` have been written before those that are added first.
  CutShape(const FinestBrick& brick, std::size_t number, std::size_t tets) noexcept
      : brick_(brick),
        number_(number),
        shape_(kTetShape[number]),
        keys_(kShapeKeys[number]),
        tets_(tets) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t o = node_around_cell(shape_, i);
      plus_[i] = &brick.nodes.plus[shape_.kind[i]][o];
      zero_[i] = &brick.nodes.zero[shape_.kind[i]][o];
    }
  }

  /// Adds those of the tet in the cell at a bit of a slice.
  void add(int x, int bit, StuffedTets& out) noexcept {
    const int cell = cell_slot(x, bit);
    const std::size_t stencil = stencil_of(static_cast<std::size_t>(x), bit);
    if (brick_.faces != nullptr) look_at_faces(stencil, x, bit);
    if (CutTet::has_columns(stencil)) {
      const EdgeFractions fraction = fractions(cell);
      const CutTet cut_tet(shape_, stencil, fraction, brick_.nodes.region, brick_.rules);
      const Slot middle =
          cut_tet.has_fan() ? brick_.vertices.fan_slot(number_, x, bit) : Slot{0};
      add_stencil(cut_tet.tets(), cell, middle, out);
    } else {
      add_stencil(kStencils[stencil][0].tets(), cell, 0, out);
    }
  }

 private:
  std::size_t stencil_of(std::size_t x, int bit) const noexcept {
    std::size_t number = 0;
    for (std::size_t i = 4; i-- > 0;) {
      number =
          3 * number + 2 * (plus_[i]->slice[x] >> bit & 1) + (zero_[i]->slice[x] >> bit & 1);
    }
    return number;
  }

  EdgeFractions fractions(int cell) const noexcept {
    EdgeFractions fraction;
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      fraction[e] =
          brick_.vertices.fraction(brick_.vertices.slot(keys_.corner[cut_on_edge(e)] + cell));
    }
    return fraction;
  }

  void add_stencil(StencilTets tets, int cell, Slot middle, StuffedTets& out) noexcept {
    const auto slot = [&](StencilVertex vertex) {
      return vertex == kQuadCentre ? middle : brick_.vertices.slot(keys_.corner[vertex] + cell);
    };
    for (auto tet : tets) {
      auto& [a, b, c, d] = tet;
      if (shape_.negative) std::swap(c, d);
      const LocalTet corners{slot(a), slot(b), slot(c), slot(d)};
      out.add(corners);
      if (brick_.faces != nullptr) add_face(tet, corners);
      ++tets_;
    }
  }

  void look_at_faces(std::size_t stencil, int x, int bit) noexcept {
    const DomainFaces* const domain = brick_.faces->around.domain;
    zeros_ = kZeroNodes[stencil];
    behind_dents_ = domain == nullptr ? 0 : domain->behind_dents(number_, x, bit >> 3, bit & 7);
  }

  void add_face(const std::array<StencilVertex, 4>& tet,
                const LocalTet& corners) const noexcept {
    LocalFaces& faces = brick_.faces->faces;
    if (brick_.nodes.region == MeshRegion::kInside) {
      faces.add_if_on_surface(tets_, opposite_surface(tet, zeros_), corners);
    }
    for (std::size_t k = 0; k < 4 && behind_dents_ != 0; ++k) {
      if ((behind_dents_ >> k & 1) != 0) add_faces_on(k, tet, faces);
    }
  }

  /// Notes those on the lattice tet's face opposite node `k`.
  void add_faces_on(std::size_t k,
                    const std::array<StencilVertex, 4>& tet,
                    LocalFaces& faces) const noexcept {
    std::size_t off = 0, opposite = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if ((kVerticesOnFace[k] >> tet[i] & 1) != 0) continue;
      ++off;
      opposite = i;
    }
    if (off != 1) return;
    faces.add(tets_, opposite, label_of_direction(DomainFaces::direction_of(number_)));
  }

  const FinestBrick& brick_;
  std::size_t number_;
  const TetShape& shape_;
  const ShapeKeys& keys_;
  std::array<const BrickMask*, 4> plus_, zero_;
  std::size_t tets_;           // written so far
  unsigned zeros_ = 0;         // nodes of the tet being added
  unsigned behind_dents_ = 0;  // the same, opposite faces at the domain's end
};

TET_VECTOR_CLONES
void add_cut(const FinestBrick& brick,
             std::size_t shape,
             const BrickMask& cut,
             std::size_t tets,
             StuffedTets& out) noexcept {
  CutShape cut_shape(brick, shape, tets);
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

/// From a cell's slot to the corners of its face across a direction, from where the diagonal
/// starts, by the direction and by which of the cell's coordinates are odd (4*x + 2*y + z).
constexpr auto kFaceCornerSlots = [] {
  std::array<std::array<std::array<std::int16_t, 4>, 8>, kFaceDirections> slots{};
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    for (int odd = 0; odd < 8; ++odd) {
      const int start = diagonal_turn(direction, Cell(odd >> 2, odd >> 1 & 1, odd & 1));
      for (int turn = 0; turn < 4; ++turn) {
        const LatticeCoord at = face_turn(direction, (start + turn) & 3);
        slots[static_cast<std::size_t>(direction)][static_cast<std::size_t>(odd)]
             [static_cast<std::size_t>(turn)] =
                 static_cast<std::int16_t>(node_slot(at.x, at.y, at.z));
      }
    }
  }
  return slots;
}();

/// `tets` have been written before.
template <class Index>
[[gnu::always_inline]] inline Index* write_half_pyramids_of_finest(
    const FinestBrick& brick,
    const SlotIds<Index>& ids,
    Index* out,
    std::size_t tets,
    BackgroundCounts& counts) noexcept {
  const CellNodes& nodes = brick.nodes;
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const BrickMask cells = half_pyramids_of_finest(nodes, direction);
    counts.half_pyramid += 2 * std::uint64_t{cells.count()};
    if (brick.faces != nullptr && brick.faces->around.domain != nullptr) {
      brick.faces->around.domain->add_half_pyramids(cells, direction, tets, brick.faces->faces);
    }
    tets += 2 * std::size_t{cells.count()};
    const auto& corners = kFaceCornerSlots[static_cast<std::size_t>(direction)];
    for_each_bit(cells, [&](int x, int y, int z) {
      const Index* const at = ids.data() + node_slot(x, y, z);
      const int odd = (x & 1) * 4 + (y & 1) * 2 + (z & 1);
      const auto [a, b, c, d] = corners[static_cast<std::size_t>(odd)];
      out = write_tet(out, at[kSlotsOfKind], at[a], at[b], at[c]);
      out = write_tet(out, at[kSlotsOfKind], at[a], at[c], at[d]);
    });
  }
  return out;
}

}  // namespace

template <class Index>
TET_VECTOR_CLONES Index* fill_finest(const FinestBrick& brick,
                                     const SlotIds<Index>& ids,
                                     Index* tets,
                                     const Index* end,
                                     StuffedTets& stuffed,
                                     BackgroundCounts& counts) noexcept {
  const Index* const begin = tets;
  const std::size_t first_tet = brick.faces == nullptr ? 0 : brick.faces->first_tet;
  const auto written = [&] { return first_tet + static_cast<std::size_t>(tets - begin) / 4; };
  const WholeOnSurface surface(brick);
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    const ShapeTets found = tets_of_shape(brick.nodes, shape);
    if (brick.faces != nullptr) {
      add_faces_of_whole(brick, shape, found.whole, surface.of_shape(shape), written());
    }
    tets = write_rows(found.whole, kShapeKeys[shape].whole, ids.data(), tets, end);
    counts.bcc += found.regular.count();
    if (brick.statistics == Statistics::kMeasured) {
      add_moved(kShapeKeys[shape].whole, found.whole & ~found.regular, stuffed);
    }
    const std::size_t first_cut = stuffed.count();
    add_cut(brick, shape, found.cut, written(), stuffed);
    tets = write_local(stuffed.from(first_cut), ids, tets);
  }
  return write_half_pyramids_of_finest(brick, ids, tets, written(), counts);
}

template std::uint32_t* fill_finest(const FinestBrick&,
                                    const SlotIds<std::uint32_t>&,
                                    std::uint32_t*,
                                    const std::uint32_t*,
                                    StuffedTets&,
                                    BackgroundCounts&) noexcept;
template std::uint64_t* fill_finest(const FinestBrick&,
                                    const SlotIds<std::uint64_t>&,
                                    std::uint64_t*,
                                    const std::uint64_t*,
                                    StuffedTets&,
                                    BackgroundCounts&) noexcept;

}  // namespace tet
