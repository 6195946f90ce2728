#include "core/stuffing/count_tets.h"

#include <bit>

namespace tet {
namespace {

/// One shape's tets in eight rows of cells, bit by bit.
struct ShapeBits {
  std::uint64_t any_plus = 0, no_minus = ~std::uint64_t{0}, any_zero = 0;
  std::uint64_t odd = 0, pairs = 0;  ///< the two low digits of the number of `+` nodes

  ShapeBits(const CellNodes& nodes, const TetShape& shape, std::size_t x) noexcept {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t at = node_around_cell(shape, i);
      const std::uint64_t plus = nodes.plus[shape.kind[i]][at].slice[x];
      const std::uint64_t zero = nodes.zero[shape.kind[i]][at].slice[x];
      any_plus |= plus;
      no_minus &= plus | zero;
      any_zero |= zero;
      pairs ^= odd & plus;
      odd ^= plus;
    }
  }
  std::uint64_t cut() const noexcept { return any_plus & ~no_minus; }
  std::uint64_t one() const noexcept { return odd & ~pairs; }
  std::uint64_t two() const noexcept { return pairs & ~odd; }
  std::uint64_t three() const noexcept { return pairs & odd; }
};

std::uint64_t bits_of(std::uint64_t word) noexcept {
  return static_cast<std::uint64_t>(std::popcount(word));
}

/// Tets that the stencils of one shape emit: 1, and more where nodes are cut away (see
/// stencil.h).
std::uint64_t count_stencil_tets(const CellNodes& nodes, std::size_t shape) noexcept {
  // Outside, tets of four zeros are meshed too.
  const std::uint64_t keeps_zeros =
      nodes.region == MeshRegion::kOutside ? ~std::uint64_t{0} : 0;
  std::uint64_t count = 0;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t tets = nodes.pairs[shape / 4].slice[x];
    if (tets == 0) continue;
    const ShapeBits bits(nodes, kTetShape[shape], x);
    count += bits_of(tets & (bits.any_plus | (keeps_zeros & bits.no_minus)));
    const std::uint64_t cut = tets & bits.cut();
    if (cut == 0) continue;
    const std::uint64_t two = cut & bits.two();
    count += bits_of(two);                     // ++0-: 2
    count += bits_of(two & ~bits.any_zero);    // ++--: 3
    count += 2 * bits_of(cut & bits.three());  // +++-: 3
  }
  return count;
}

}  // namespace

std::uint64_t count_finest(const CellNodes& nodes, const FanMasks* fans) noexcept {
  std::uint64_t count = 0;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    count += count_stencil_tets(nodes, shape);
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    count += 2 * std::uint64_t{half_pyramids_of_finest(nodes, direction).count()};
  }
  if (fans != nullptr) {
    for (const BrickMask& fan : *fans) count += 3 * std::uint64_t{fan.count()};  // 6, not 3
  }
  return count;
}

std::uint64_t count_cut_triangles(const CellNodes& nodes, ThreeZeros& three_zeros) noexcept {
  std::uint64_t count = 0;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    for (std::size_t x = 0; x < 8; ++x) {
      const ShapeBits bits(nodes, kTetShape[shape], x);
      three_zeros[shape].slice[x] = bits.no_minus & bits.one();
      const std::uint64_t cut = bits.cut();
      if (cut == 0) continue;
      count += bits_of(cut) + bits_of(cut & bits.two() & ~bits.any_zero);  // ++--: a quad
    }
  }
  return count;
}

}  // namespace tet
