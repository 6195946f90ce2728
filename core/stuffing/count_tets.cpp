#include "core/stuffing/count_tets.h"

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// One shape's tets in eight rows of cells, bit by bit.
struct ShapeBits {
  std::uint64_t any_plus = 0, no_minus = ~std::uint64_t{0}, any_zero = 0;
  std::uint64_t odd = 0, pairs = 0;  ///< the two low digits of the number of `+` nodes

  void add_node(std::uint64_t plus, std::uint64_t zero) noexcept {
    any_plus |= plus;
    no_minus &= plus | zero;
    any_zero |= zero;
    pairs ^= odd & plus;
    odd ^= plus;
  }
  std::uint64_t cut() const noexcept { return any_plus & ~no_minus; }
  std::uint64_t one() const noexcept { return odd & ~pairs; }
  std::uint64_t two() const noexcept { return pairs & ~odd; }
  std::uint64_t three() const noexcept { return pairs & odd; }
};

/// The four nodes of one shape's tets.
struct ShapeNodes {
  std::array<const BrickMask*, 4> plus, zero;

  ShapeNodes(const CellNodes& nodes, const TetShape& shape) noexcept {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t at = node_around_cell(shape, i);
      plus[i] = &nodes.plus[shape.kind[i]][at];
      zero[i] = &nodes.zero[shape.kind[i]][at];
    }
  }
  ShapeBits slice(std::size_t x) const noexcept {
    ShapeBits bits;
    for (std::size_t i = 0; i < 4; ++i) bits.add_node(plus[i]->slice[x], zero[i]->slice[x]);
    return bits;
  }
};

/// A number for each cell, by its binary digits.
struct CellCounts {
  std::array<BrickMask, 6> digit;  ///< a cell has at most 3 tets of each of 12 shapes

  /// Adds 1 to the cells of slice x that are in `ones`, and 2 to those in `twos`.
  void add(std::size_t x, std::uint64_t ones, std::uint64_t twos) noexcept {
    const auto add_digit = [&](std::size_t d, std::uint64_t more) {
      const std::uint64_t carry = digit[d].slice[x] & more;
      digit[d].slice[x] ^= more;
      return carry;
    };
    std::uint64_t carry = add_digit(0, ones);
    carry = add_digit(1, carry) | add_digit(1, twos);  // not both: the first leaves 0
    for (std::size_t d = 2; d < digit.size(); ++d) carry = add_digit(d, carry);
  }
  std::uint64_t total() const noexcept {
    std::uint64_t sum = 0;
    for (std::size_t d = 0; d < digit.size(); ++d) {
      sum += std::uint64_t{digit[d].count()} << d;
    }
    return sum;
  }
};

/// Tets that the stencils emit: 1 for each tet, and more where nodes are cut away (see
/// stencil.h).
TET_VECTOR_CLONES
std::uint64_t count_stencil_tets(const CellNodes& nodes) noexcept {
  // Outside, tets of four zeros are meshed too.
  const std::uint64_t keeps_zeros =
      nodes.region == MeshRegion::kOutside ? ~std::uint64_t{0} : 0;
  CellCounts counts;
  for (std::size_t number = 0; number < kTetShapes; ++number) {
    const ShapeNodes shape(nodes, kTetShape[number]);
    const BrickMask& pairs = nodes.pairs[number / 4];
    for (std::size_t x = 0; x < 8; ++x) {
      const ShapeBits bits = shape.slice(x);
      const std::uint64_t meshed = bits.any_plus | (keeps_zeros & bits.no_minus);
      const std::uint64_t cut = bits.cut();
      const std::uint64_t in_two = cut & bits.two() & bits.any_zero;    // ++0-
      const std::uint64_t in_more = cut & (bits.two() | bits.three());  // the same, ++--, +++-
      counts.add(x, pairs.slice[x] & meshed & ~in_two, pairs.slice[x] & in_more);
    }
  }
  return counts.total();
}

/// Tets of half pyramids, and those that fans have beyond the stencils that they stand for.
std::uint64_t count_others(const CellNodes& nodes, const FanMasks* fans) noexcept {
  std::uint64_t count = 0;
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    count += 2 * std::uint64_t{half_pyramids_of_finest(nodes, direction).count()};
  }
  if (fans != nullptr) {
    for (const BrickMask& fan : *fans) count += 3 * std::uint64_t{fan.count()};  // 6, not 3
  }
  return count;
}

/// Counts tets of the inside's stencils, and the surface's triangles in cut ones; notes tets on
/// three zeros.
TET_VECTOR_CLONES
FinestCounts count_stencils(const CellNodes& nodes, ThreeZeros& three_zeros) noexcept {
  CellCounts tets, triangles;
  for (std::size_t number = 0; number < kTetShapes; ++number) {
    const ShapeNodes shape(nodes, kTetShape[number]);
    const BrickMask& pairs = nodes.pairs[number / 4];
    BrickMask& zeros = three_zeros[number];
    for (std::size_t x = 0; x < 8; ++x) {
      const ShapeBits bits = shape.slice(x);
      const std::uint64_t cut = bits.cut() & pairs.slice[x], two = bits.two();
      const std::uint64_t quad = cut & two & ~bits.any_zero;  // ++--
      tets.add(x, pairs.slice[x] & bits.any_plus & ~(cut & two & bits.any_zero),
               cut & (two | bits.three()));
      triangles.add(x, cut & ~quad, quad);
      zeros.slice[x] = pairs.slice[x] & bits.no_minus & bits.one();
    }
  }
  return {tets.total(), triangles.total()};
}

}  // namespace

std::uint64_t count_finest(const CellNodes& nodes, const FanMasks* fans) noexcept {
  return count_stencil_tets(nodes) + count_others(nodes, fans);
}

NumberedShape number_shape(const CellNodes& nodes, std::size_t number) noexcept {
  const ShapeNodes shape(nodes, kTetShape[number]);
  const BrickMask& pairs = nodes.pairs[number / 4];
  const std::uint64_t keeps_zeros =
      nodes.region == MeshRegion::kOutside ? ~std::uint64_t{0} : 0;
  NumberedShape counted;
  for (std::size_t x = 0; x < 8; ++x) {
    const ShapeBits bits = shape.slice(x);
    const std::uint64_t cut = pairs.slice[x] & bits.cut();
    counted.whole.slice[x] = pairs.slice[x] & (bits.any_plus | keeps_zeros) & bits.no_minus;
    counted.cut.slice[x] = cut;
    counted.in_two.slice[x] = cut & bits.two() & bits.any_zero;
    counted.in_three.slice[x] = cut & ((bits.two() & ~bits.any_zero) | bits.three());
  }
  return counted;
}

FinestCounts count_finest_and_surface(const CellNodes& nodes,
                                      const FanMasks* fans,
                                      ThreeZeros& three_zeros) noexcept {
  FinestCounts counts = count_stencils(nodes, three_zeros);
  counts.tets += count_others(nodes, fans);
  return counts;
}

TET_VECTOR_CLONES
void find_three_zeros(const CellNodes& nodes, ThreeZeros& three_zeros) noexcept {
  for (std::size_t number = 0; number < kTetShapes; ++number) {
    const ShapeNodes shape(nodes, kTetShape[number]);
    const BrickMask& pairs = nodes.pairs[number / 4];
    for (std::size_t x = 0; x < 8; ++x) {
      const ShapeBits bits = shape.slice(x);
      three_zeros[number].slice[x] = pairs.slice[x] & bits.no_minus & bits.one();
    }
  }
}

}  // namespace tet
