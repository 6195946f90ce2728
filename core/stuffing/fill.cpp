#include "core/stuffing/fill.h"

#include <bit>
#include <cstddef>

#include "core/stuffing/stencil.h"
#include "core/stuffing/surface_diagonal.h"

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

/// A lattice tet with at least one node cut away, and all that its stencil asks for.
template <class Index>
class CutTet {
 public:
  CutTet(const TetShape& shape,
         const ShapeSigns& signs,
         int cell,
         const StuffedLattice& lattice)
      : shape_(shape), cell_(cell), lattice_(lattice) {
    for (std::size_t i = 0; i < 4; ++i) {
      sign_[i] = signs.plus[i]->test(cell)   ? NodeSign::kPlus
                 : signs.zero[i]->test(cell) ? NodeSign::kZero
                                             : NodeSign::kMinus;
      if (sign_[i] == NodeSign::kPlus) plus_[plus_count_++] = i;
      if (sign_[i] == NodeSign::kMinus) minus_[minus_count_++] = i;
    }
  }

  const Stencil& stencil() const noexcept {
    return kStencils[stencil_number(sign_[0], sign_[1], sign_[2], sign_[3])][choice()];
  }

  Index id(StencilVertex vertex, const FinestIds<Index>& ids) const noexcept {
    if (vertex < 4) return ids.node[shape_.kind[vertex]][node(vertex)];
    const auto edge = static_cast<std::size_t>(vertex - 4);
    return ids.cut[shape_.edge_family[edge]][node(kTetEdge[edge][0])];
  }

  WorldPoint place(StencilVertex vertex) const noexcept {
    if (vertex < 4) {
      return lattice_.place_of_node(shape_.kind[vertex], static_cast<int>(node(vertex)));
    }
    const auto edge = static_cast<std::size_t>(vertex - 4);
    return lattice_.place_of_cut(shape_.edge_family[edge],
                                 static_cast<int>(node(kTetEdge[edge][0])));
  }

 private:
  /// Halo index of one of the four nodes.
  std::size_t node(std::size_t i) const noexcept {
    return static_cast<std::size_t>(cell_ + shape_.offset[i]);
  }

  /// Length of the column on the edge from a `+` node to a `-` node.
  float column(std::size_t plus, std::size_t minus) const noexcept {
    const std::size_t low = std::min(plus, minus);
    const float fraction =
        lattice_.cuts.fraction[shape_.edge_family[edge_between(plus, minus)]][node(low)];
    return plus == low ? fraction : 1 - fraction;
  }

  /// True when q's column is the longer one; p is the lower node and wins a tie.
  bool second_longer(std::size_t p, std::size_t q, std::size_t minus) const noexcept {
    return column(q, minus) > column(p, minus);
  }

  std::size_t choice() const noexcept {
    const auto [p, q, r, s] = plus_;
    const auto [m, n, o, t] = minus_;
    if (plus_count_ == 1) return 0;
    const bool first = second_longer(p, q, m);
    if (plus_count_ == 3) {
      return std::size_t{first} | std::size_t{second_longer(p, r, m)} << 1 |
             std::size_t{second_longer(q, r, m)} << 2;
    }
    if (minus_count_ == 1) return std::size_t{first};
    const bool second = second_longer(p, q, n);
    return std::size_t{first} | std::size_t{second} << 1 |
           std::size_t{surface_diagonal(p, q, m, n, first, second)} << 2;
  }

  /// Where the two columns' faces disagree one diagonal would close a cycle; else angles
  /// decide.
  bool surface_diagonal(std::size_t p,
                        std::size_t q,
                        std::size_t m,
                        std::size_t n,
                        bool first,
                        bool second) const noexcept {
    if (first != second) return second;
    const auto cut = [&](std::size_t a, std::size_t b) {
      return place(cut_on_edge(edge_between(a, b)));
    };
    return second_diagonal_is_better(place(static_cast<StencilVertex>(first ? q : p)),
                                     cut(p, m), cut(q, m), cut(q, n), cut(p, n));
  }

  const TetShape& shape_;
  int cell_;
  const StuffedLattice& lattice_;
  std::array<NodeSign, 4> sign_{};
  std::array<std::size_t, 4> plus_{}, minus_{};
  std::size_t plus_count_ = 0, minus_count_ = 0;
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
Index* write_cut(const TetShape& shape,
                 const ShapeSigns& signs,
                 const FinestIds<Index>& ids,
                 const StuffedLattice& lattice,
                 Index* out,
                 QualityMeter& meter) noexcept {
  for_each_bit(signs.cut, [&](int cell) {
    const CutTet<Index> cut_tet(shape, signs, cell, lattice);
    const Stencil& stencil = cut_tet.stencil();
    for (std::size_t t = 0; t < stencil.tet_count; ++t) {
      auto [a, b, c, d] = stencil.tet[t];
      if (shape.negative) std::swap(c, d);
      out = write_tet(out, cut_tet.id(a, ids), cut_tet.id(b, ids), cut_tet.id(c, ids),
                      cut_tet.id(d, ids));
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
    const HaloSet cells = faces_to_larger({nodes.leaf, {}}, direction) & nodes.plus[kCentre];
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

WorldPoint lattice_place(NodeKind kind, int index) noexcept {
  const LatticeCoord at = node_coord(kind, index);
  return {0.5 * at.x, 0.5 * at.y, 0.5 * at.z};
}

WorldPoint StuffedLattice::place_of_cut(int family, int index) const noexcept {
  const LatticeCoord along = kDirection[static_cast<std::size_t>(family_direction(family))];
  const double t =
      0.5 *
      static_cast<double>(
          cuts.fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(index)]);
  const WorldPoint from = lattice_place(family_kind(family), index);
  return {from.x + t * along.x, from.y + t * along.y, from.z + t * along.z};
}

WorldPoint StuffedLattice::place_of_node(NodeKind kind, int index) const noexcept {
  if (!warped.warped[kind].test(index)) return lattice_place(kind, index);
  // The edge's lower node owns the cut point: seen from either end it is the same place.
  const int direction = warped.direction[kind][static_cast<std::size_t>(index)];
  if (direction < kOwnedDirections) return place_of_cut(edge_family(kind, direction), index);
  return place_of_cut(edge_family(end_kind(kind, direction), opposite(direction)),
                      index + end_offset(kind, direction));
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
Index* fill_finest(const FinestNodes& nodes,
                   const FinestIds<Index>& ids,
                   const StuffedLattice* lattice,
                   Index* tets,
                   QualityMeter& meter,
                   BackgroundCounts& counts) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const FaceSigns faces = signs_around_faces(nodes, axis);
    for (const TetShape& shape : shapes_across(axis)) {
      const ShapeSigns signs = signs_of_shape(faces, shape);
      tets = write_whole(shape, signs, ids, tets);
      counts.bcc += signs.regular.count();
      if (lattice == nullptr) continue;
      measure_moved(shape, signs, *lattice, meter);
      tets = write_cut(shape, signs, ids, *lattice, tets, meter);
    }
  }
  return write_half_pyramids_of_finest(nodes, ids, tets, counts);
}

template void number_vertices(
    const OwnedVertices&, int, int, int, FinestIds<std::uint32_t>&) noexcept;
template void number_vertices(
    const OwnedVertices&, int, int, int, FinestIds<std::uint64_t>&) noexcept;
template std::uint32_t* fill_finest(const FinestNodes&,
                                    const FinestIds<std::uint32_t>&,
                                    const StuffedLattice*,
                                    std::uint32_t*,
                                    QualityMeter&,
                                    BackgroundCounts&) noexcept;
template std::uint64_t* fill_finest(const FinestNodes&,
                                    const FinestIds<std::uint64_t>&,
                                    const StuffedLattice*,
                                    std::uint64_t*,
                                    QualityMeter&,
                                    BackgroundCounts&) noexcept;

}  // namespace tet
