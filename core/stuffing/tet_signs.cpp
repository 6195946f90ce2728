#include "core/stuffing/tet_signs.h"

#include <bit>

namespace tet {
namespace {

/// Which of the nodes around its cell a tet has, by shape.
constexpr std::array<std::array<std::uint8_t, 4>, kTetShapes> kNodeOfTet = [] {
  std::array<std::array<std::uint8_t, 4>, kTetShapes> nodes{};
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::uint8_t n = 0; n < kCellNodes; ++n) {
        const CellNode& node = kCellNode[n];
        if (node.kind == kTetShape[s].kind[i] &&
            offset_index(node.dx, node.dy, node.dz) == kTetShape[s].offset[i]) {
          nodes[s][i] = n;
        }
      }
    }
  }
  return nodes;
}();

/// One shape's tets in eight rows of cells, bit by bit.
struct ShapeBits {
  std::uint64_t any_plus, no_minus, any_zero;
  std::uint64_t odd, pairs;  ///< the two low digits of the number of `+` nodes; 4 is 0

  ShapeBits(const TetSigns& signs, std::size_t shape, std::size_t slice) noexcept
      : any_plus(0), no_minus(~std::uint64_t{0}), any_zero(0), odd(0), pairs(0) {
    for (const std::uint8_t node : kNodeOfTet[shape]) {
      const std::uint64_t plus = signs.plus[node].slice[slice];
      const std::uint64_t zero = signs.zero[node].slice[slice];
      any_plus |= plus;
      no_minus &= plus | zero;
      any_zero |= zero;
      pairs ^= odd & plus;
      odd ^= plus;
    }
  }
  std::uint64_t cut() const noexcept { return any_plus & ~no_minus; }
  /// Of cut tets.
  std::uint64_t two() const noexcept { return pairs & ~odd; }
  std::uint64_t three() const noexcept { return pairs & odd; }
};

std::uint64_t bits_of(std::uint64_t word) noexcept {
  return static_cast<std::uint64_t>(std::popcount(word));
}

}  // namespace

TetSigns signs_around_cells(const std::array<HaloSet, kNodeKinds>& plus,
                            const std::array<HaloSet, kNodeKinds>& zero) noexcept {
  TetSigns signs;
  for (std::size_t n = 0; n < kCellNodes; ++n) {
    const auto [kind, dx, dy, dz] = kCellNode[n];
    signs.plus[n] = brick_part(plus[kind], dx, dy, dz);
    signs.zero[n] = brick_part(zero[kind], dx, dy, dz);
  }
  return signs;
}

TetSigns seen_from_outside(const TetSigns& inside) noexcept {
  TetSigns outside = inside;
  for (std::size_t n = 0; n < kCellNodes; ++n) {
    outside.plus[n] = ~(inside.plus[n] | inside.zero[n]);
  }
  return outside;
}

std::uint64_t count_stencil_tets(const TetSigns& signs,
                                 const FaceMasks& faces,
                                 MeshRegion region) noexcept {
  // Outside, tets of four zeros are meshed too.
  const std::uint64_t keeps_zeros = region == MeshRegion::kOutside ? ~std::uint64_t{0} : 0;
  std::uint64_t count = 0;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    for (std::size_t x = 0; x < 8; ++x) {
      const std::uint64_t tets = faces[shape / 4].slice[x];
      if (tets == 0) continue;
      const ShapeBits bits(signs, shape, x);
      count += bits_of(tets & (bits.any_plus | (keeps_zeros & bits.no_minus)));
      const std::uint64_t cut = tets & bits.cut();
      if (cut == 0) continue;
      const std::uint64_t two = cut & bits.two();
      count += bits_of(two);                     // ++0-: 2
      count += bits_of(two & ~bits.any_zero);    // ++--: 3
      count += 2 * bits_of(cut & bits.three());  // +++-: 3
    }
  }
  return count;
}

std::uint64_t count_cut_triangles(const TetSigns& signs, ThreeZeros& three_zeros) noexcept {
  std::uint64_t count = 0;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    for (std::size_t x = 0; x < 8; ++x) {
      const ShapeBits bits(signs, shape, x);
      const std::uint64_t cut = bits.cut();
      three_zeros[shape].slice[x] = bits.no_minus & bits.odd & ~bits.pairs;
      if (cut == 0) continue;
      count += bits_of(cut) + bits_of(cut & bits.two() & ~bits.any_zero);  // ++--: a quad
    }
  }
  return count;
}

}  // namespace tet
