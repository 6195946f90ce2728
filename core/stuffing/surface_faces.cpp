#include "core/stuffing/surface_faces.h"

#include <bit>

namespace tet {
namespace {

/// Keeps of some tets `+000` those whose face of zeros has no tet of the inside behind it, and
/// does not lie at the domain's end.
BrickMask without_inside_behind(const CellNodes& inside,
                                const FacesAround& around,
                                std::size_t shape,
                                const BrickMask& three_zeros) noexcept {
  const NodesAround nodes(around.around);
  BrickMask open;
  for_each_bit(three_zeros, [&](int x, int y, int z) {
    const std::size_t plus = plus_node(inside, shape, x, y, z);
    const bool at_end = around.domain != nullptr &&
                        (around.domain->behind_dents(shape, x, y, z) >> plus & 1) != 0;
    const Cell behind(halo_index(x, y, z) + kMirrored[shape][plus]);
    if (!at_end && !nodes.is_plus(kTetShape[shape].kind[plus], behind.x, behind.y, behind.z)) {
      open.set(x, y, z);
    }
  });
  return open;
}

}  // namespace

std::size_t plus_node(const CellNodes& nodes, std::size_t shape, int x, int y, int z) noexcept {
  const TetShape& of = kTetShape[shape];
  std::size_t plus = 0;
  while (!nodes.plus[of.kind[plus]][node_around_cell(of, plus)].test(x, y, z)) ++plus;
  return plus;
}

BrickMask tets_on_surface(const CellNodes& inside,
                          const FacesAround& around,
                          std::size_t shape) noexcept {
  return without_inside_behind(inside, around, shape, tets_on_three_zeros(inside, shape));
}

FinestCounts count_finest_with_faces(const CellNodes& inside,
                                     const FacesAround& around,
                                     const FanMasks* fans) noexcept {
  ThreeZeros three_zeros;
  FinestCounts counts = count_finest_and_surface(inside, fans, three_zeros);
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    counts.triangles +=
        without_inside_behind(inside, around, shape, three_zeros[shape]).count();
    if (fans != nullptr)
      counts.triangles += 2 * std::uint64_t{(*fans)[shape].count()};  // 4, not 2
  }
  return counts;
}

}  // namespace tet
