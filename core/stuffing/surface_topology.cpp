#include "core/stuffing/surface_topology.h"

#include <bit>
#include <cstddef>

#include "core/base/vector_clones.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/count_tets.h"
#include "core/stuffing/node_link.h"

namespace tet {
namespace {

/// Counts the tets `+000` whose three zeros are a triangle of the boundary: the tet behind them
/// is not inside, too.
std::uint64_t count_zero_triangles(const WarpedLattice& lattice,
                                   const ThreeZeros& three_zeros) noexcept {
  std::uint64_t count = 0;
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    const TetShape& shape = kTetShape[s];
    for_each_bit(three_zeros[s], [&](int x, int y, int z) {
      const int cell = halo_index(x, y, z);
      std::size_t plus = 0;
      while (!lattice.plus[shape.kind[plus]].test(cell + shape.offset[plus])) ++plus;
      count += lattice.plus[shape.kind[plus]].test(cell + kMirrored[s][plus]) ? 0 : 1;
    });
  }
  return count;
}

std::uint64_t count_cut_points(const StuffedBrick& kept) noexcept {
  std::uint64_t count = 0;
  for (const BrickMask& cut : kept.cut) count += cut.count();
  return count;
}

/// Counts what the surface has at a zero node.
void count_zero(const NodeLink& link, SurfaceCounts& counts) noexcept {
  if (link.plus == 0) return;
  const bool beside_minus = (link.plus | link.zero) != kAllDirections;
  if (beside_minus && is_plainly_manifold(link)) {
    ++counts.vertices;
    return;
  }
  const SurfaceAtNode surface = surface_at(link);
  counts.vertices += surface.on_surface ? 1 : 0;
  counts.non_manifold_edges += static_cast<std::uint64_t>(surface.non_manifold_edges);
  counts.extra_pairs += static_cast<std::uint64_t>(surface.extra_pairs);
  counts.non_manifold_vertices += surface.manifold ? 0 : 1;
}

/// Counts what the surface has at all of the brick's own zero nodes.
void count_zeros(const WarpedLattice& lattice,
                 const StuffedBrick& kept,
                 SurfaceCounts& counts) noexcept {
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int x = 0; x < 8; ++x) {
      std::uint64_t bits = kept.zero[kind].slice[static_cast<std::size_t>(x)];
      if (bits == 0) continue;
      const LinksOfSlice links(lattice.plus, lattice.zero, kind, x);
      for (; bits != 0; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        count_zero(links.at(bit >> 3, bit & 7), counts);
      }
    }
  }
}

}  // namespace

void SurfaceCounts::add(const SurfaceCounts& more) noexcept {
  triangles += more.triangles;
  vertices += more.vertices;
  non_manifold_edges += more.non_manifold_edges;
  extra_pairs += more.extra_pairs;
  non_manifold_vertices += more.non_manifold_vertices;
}

void SurfaceCounts::add_fans(std::uint64_t fans) noexcept {
  vertices += fans;
  triangles += 2 * fans;
}

std::int64_t SurfaceCounts::euler_characteristic() const noexcept {
  const auto edges = static_cast<std::int64_t>(3 * triangles / 2 - extra_pairs);
  return static_cast<std::int64_t>(vertices) - edges + static_cast<std::int64_t>(triangles);
}

TET_VECTOR_CLONES
SurveyedSurface survey_surface(const WarpedLattice& lattice,
                               const StuffedBrick& kept) noexcept {
  SurveyedSurface found;
  ThreeZeros three_zeros;
  found.counts.triangles =
      count_cut_triangles(nodes_around_cells(lattice.plus, lattice.zero), three_zeros);
  found.counts.triangles += count_zero_triangles(lattice, three_zeros);
  found.counts.vertices = count_cut_points(kept);
  count_zeros(lattice, kept, found.counts);
  found.sheet = surface_sheet(lattice.plus, lattice.zero);
  return found;
}

NodeMasks non_manifold_nodes(const std::array<HaloSet, kNodeKinds>& plus,
                             const std::array<HaloSet, kNodeKinds>& zero) noexcept {
  std::array<HaloSet, kNodeKinds> bad;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(zero[kind] & kOwnNodes, [&](int node) {
      const NodeLink link = link_of(plus, zero, kind, node);
      if (link.plus != 0 && !surface_at(link).manifold) bad[kind].set(node);
    });
  }
  return {brick_part(bad[kCorner]), brick_part(bad[kCentre])};
}

}  // namespace tet
