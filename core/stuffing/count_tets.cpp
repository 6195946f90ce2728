#include "core/stuffing/count_tets.h"

#include <bit>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// One shape's tets in eight rows of cells, bit by bit.
struct ShapeBits {
  std::uint64_t any_plus = 0, no_minus = ~std::uint64_t{0}, any_zero = 0;
  std::uint64_t odd = 0, pairs = 0;  ///< the two low digits of the number of `+` nodes

  ShapeBits() noexcept = default;
  ShapeBits(const CellNodes& nodes, const TetShape& shape, std::size_t x) noexcept {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t at = node_around_cell(shape, i);
      add(nodes.plus[shape.kind[i]][at].slice[x], nodes.zero[shape.kind[i]][at].slice[x]);
    }
  }
  void add(std::uint64_t plus, std::uint64_t zero) noexcept {
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

namespace {

/// Tets of one shape that are cut, those among them with a quad of the surface, and those with
/// one `+` and three zeros.
struct SurfaceInShape {
  BrickMask cut, quad, three_zeros;
};

TET_VECTOR_CLONES
SurfaceInShape find_surface(const CellNodes& nodes, const TetShape& shape) noexcept {
  std::array<const BrickMask*, 4> plus, zero;
  for (std::size_t i = 0; i < 4; ++i) {
    plus[i] = &nodes.plus[shape.kind[i]][node_around_cell(shape, i)];
    zero[i] = &nodes.zero[shape.kind[i]][node_around_cell(shape, i)];
  }
  // Looked up before the loop, which vectorises then.
  const auto& [p0, p1, p2, p3] = plus;
  const auto& [z0, z1, z2, z3] = zero;
  SurfaceInShape found;
  for (std::size_t x = 0; x < 8; ++x) {
    ShapeBits bits;
    bits.add(p0->slice[x], z0->slice[x]);
    bits.add(p1->slice[x], z1->slice[x]);
    bits.add(p2->slice[x], z2->slice[x]);
    bits.add(p3->slice[x], z3->slice[x]);
    found.cut.slice[x] = bits.cut();
    found.quad.slice[x] = bits.cut() & bits.two() & ~bits.any_zero;  // ++--
    found.three_zeros.slice[x] = bits.no_minus & bits.one();
  }
  return found;
}

}  // namespace

std::uint64_t count_cut_triangles(const CellNodes& nodes, ThreeZeros& three_zeros) noexcept {
  std::uint64_t count = 0;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    const SurfaceInShape found = find_surface(nodes, kTetShape[shape]);
    count += std::uint64_t{found.cut.count()} + found.quad.count();
    three_zeros[shape] = found.three_zeros;
  }
  return count;
}

}  // namespace tet
