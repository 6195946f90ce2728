#include "core/stuffing/fill.h"

#include <bit>
#include <cstddef>

#include "core/lattice/node_numbers.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

/// Bits of a neighbour's slice that lie among the nodes [0, 8]^3.
constexpr std::uint64_t reachable_bits(int by, int bz) noexcept {
  constexpr std::uint64_t kRowZero = 0xff, kFirstOfRows = 0x0101010101010101;
  return (by == 1 ? kRowZero : ~std::uint64_t{0}) &
         (bz == 1 ? kFirstOfRows : ~std::uint64_t{0});
}

/// Gives the set bits ids from `next` on and enters those that are reachable; returns the next
/// id.
template <class Index>
Index number_mask(const BrickMask& mask,
                  int bx,
                  int by,
                  int bz,
                  Index next,
                  std::array<Index, kHaloNodes>& ids) noexcept {
  const std::uint64_t reachable = reachable_bits(by, bz);
  for (int x = 0; x < 8; ++x) {
    const std::uint64_t slice = mask.slice[static_cast<std::size_t>(x)];
    const int base = halo_index(x + 8 * bx, 8 * by, 8 * bz);
    if (bx == 0 || x == 0) {
      for (std::uint64_t bits = slice & reachable; bits != 0; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        const std::uint64_t before = slice & ((std::uint64_t{1} << bit) - 1);
        ids[static_cast<std::size_t>(base + offset_index(0, bit >> 3, bit & 7))] =
            next + static_cast<Index>(std::popcount(before));
      }
    }
    next += static_cast<Index>(std::popcount(slice));
  }
  return next;
}

/// Id of a stencil's corner.
template <class Index>
class CornerIds {
 public:
  CornerIds(const FinestIds<Index>& ids, const OwnedVertices& own, std::size_t shape)
      : ids_(ids), own_(own), shape_number_(shape), shape_(kTetShape[shape]) {}

  Index operator()(const CutTet& tet, StencilVertex vertex) const noexcept {
    if (vertex < 4) return ids_.node[shape_.kind[vertex]][tet.node(vertex)];
    if (vertex == kQuadCentre) {
      return static_cast<Index>(own_.fan(shape_number_, tet.cell()));
    }
    const auto edge = static_cast<std::size_t>(vertex - 4);
    return ids_.cut[shape_.edge_family[edge]][tet.node(kTetEdge[edge][0])];
  }

 private:
  const FinestIds<Index>& ids_;
  const OwnedVertices& own_;
  std::size_t shape_number_;
  const TetShape& shape_;
};

/// Whole tets keep their four nodes.
template <class Index>
Index* write_whole(const TetShape& shape,
                   const ShapeSigns& signs,
                   const FinestIds<Index>& ids,
                   Index* out) noexcept {
  const std::size_t third = shape.negative ? 3 : 2, fourth = shape.negative ? 2 : 3;
  const auto column = [&](std::size_t i) {
    return ids.node[shape.kind[i]].data() + shape.offset[i];
  };
  const Index *a = column(0), *b = column(1), *c = column(third), *d = column(fourth);
  for_each_bit(signs.whole,
               [&](int cell) { out = write_tet(out, a[cell], b[cell], c[cell], d[cell]); });
  return out;
}

void measure_moved(const TetShape& shape,
                   const ShapeSigns& signs,
                   const StuffedLattice& lattice,
                   QualityMeter& meter) noexcept {
  for_each_bit(signs.whole - signs.regular, [&](int cell) {
    std::array<WorldPoint, 4> place;
    for (std::size_t i = 0; i < 4; ++i) {
      place[i] = lattice.place_of_node(shape.kind[i], cell + shape.offset[i]);
    }
    if (shape.negative) std::swap(place[2], place[3]);
    meter.add_tet(place[0], place[1], place[2], place[3]);
  });
}

template <class Index>
Index* write_cut(const FinestBrick& brick,
                 std::size_t shape,
                 const ShapeSigns& signs,
                 const FinestIds<Index>& ids,
                 Index* out,
                 QualityMeter& meter) noexcept {
  const CornerIds<Index> id(ids, brick.own, shape);
  const bool negative = kTetShape[shape].negative;
  for_each_bit(signs.cut, [&](int cell) {
    const CutTet cut_tet(kTetShape[shape], signs, cell, *brick.lattice, brick.rules);
    for (auto [a, b, c, d] : cut_tet.tets()) {
      if (negative) std::swap(c, d);
      out = write_tet(out, id(cut_tet, a), id(cut_tet, b), id(cut_tet, c), id(cut_tet, d));
      meter.add_tet(cut_tet.place(a), cut_tet.place(b), cut_tet.place(c), cut_tet.place(d));
    }
  });
  return out;
}

template <class Index>
Index* write_half_pyramids_of_finest(const FinestNodes& nodes,
                                     const FinestIds<Index>& ids,
                                     Index* out,
                                     BackgroundCounts& counts) noexcept {
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const HaloSet cells = cells_with_half_pyramids(nodes, kOwnCells, direction);
    counts.half_pyramid += 2 * std::uint64_t{cells.count()};
    for_each_bit(cells, [&](int cell) {
      const auto corner = [&](int x, int y, int z) {
        return ids.node[kCorner][static_cast<std::size_t>(halo_index(x, y, z))];
      };
      out = write_half_pyramids(direction, Cell(cell),
                                ids.node[kCentre][static_cast<std::size_t>(cell)], corner, out);
    });
  }
  return out;
}

}  // namespace

std::uint64_t OwnedVertices::count() const noexcept {
  std::uint64_t vertices = node[kCorner].count() + node[kCentre].count();
  if (cut != nullptr) {
    for (const BrickMask& mask : *cut) vertices += mask.count();
  }
  if (fans != nullptr) {
    for (const BrickMask& mask : *fans) vertices += mask.count();
  }
  return vertices;
}

std::uint64_t OwnedVertices::fan(std::size_t shape, int cell) const noexcept {
  std::uint64_t id = first + count();
  for (std::size_t s = shape; s < kTetShapes; ++s) id -= (*fans)[s].count();
  const Cell at(cell);
  return id + rank_of((*fans)[shape], at.x, at.y, at.z);
}

template <class Index>
void number_vertices(
    const OwnedVertices& vertices, int bx, int by, int bz, FinestIds<Index>& ids) noexcept {
  Index next = static_cast<Index>(vertices.first);
  for (const NodeKind kind : {kCorner, kCentre}) {
    next = number_mask(vertices.node[kind], bx, by, bz, next, ids.node[kind]);
  }
  if (vertices.cut == nullptr) return;
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    next = number_mask((*vertices.cut)[f], bx, by, bz, next, ids.cut[f]);
  }
}

template <class Index>
Index* fill_finest(const FinestBrick& brick,
                   const FinestIds<Index>& ids,
                   Index* tets,
                   QualityMeter& meter,
                   BackgroundCounts& counts) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const FaceSigns faces = signs_around_faces(brick.nodes, axis);
    for (std::size_t turn = 0; turn < 4; ++turn) {
      const std::size_t number = static_cast<std::size_t>(axis) * 4 + turn;
      const TetShape& shape = kTetShape[number];
      const ShapeSigns signs = signs_of_shape(faces, shape);
      tets = write_whole(shape, signs, ids, tets);
      counts.bcc += signs.regular.count();
      if (brick.lattice == nullptr) continue;
      measure_moved(shape, signs, *brick.lattice, meter);
      tets = write_cut(brick, number, signs, ids, tets, meter);
    }
  }
  return write_half_pyramids_of_finest(brick.nodes, ids, tets, counts);
}

template void number_vertices(
    const OwnedVertices&, int, int, int, FinestIds<std::uint32_t>&) noexcept;
template void number_vertices(
    const OwnedVertices&, int, int, int, FinestIds<std::uint64_t>&) noexcept;
template std::uint32_t* fill_finest(const FinestBrick&,
                                    const FinestIds<std::uint32_t>&,
                                    std::uint32_t*,
                                    QualityMeter&,
                                    BackgroundCounts&) noexcept;
template std::uint64_t* fill_finest(const FinestBrick&,
                                    const FinestIds<std::uint64_t>&,
                                    std::uint64_t*,
                                    QualityMeter&,
                                    BackgroundCounts&) noexcept;

}  // namespace tet
