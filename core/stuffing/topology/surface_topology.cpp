#include "core/stuffing/topology/surface_topology.h"

#include <cstddef>

#include "core/stuffing/topology/count_triangles.h"
#include "core/stuffing/topology/node_link.h"
#include "core/stuffing/topology/nodes_near.h"
#include "core/stuffing/topology/plain_zeros.h"

namespace tet {
namespace {

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
                 const NodesNear& nodes,
                 SurfaceCounts& counts) noexcept {
  const NodeMasks plain = plain_zeros(nodes, corner_with_most(kept.plus[kCorner]));
  for (const NodeKind kind : {kCorner, kCentre}) {
    counts.vertices += (kept.zero[kind] & plain[kind]).count();
    for_each_bit(kept.zero[kind] & ~plain[kind], [&](int x, int y, int z) {
      count_zero(link_of(lattice.plus, lattice.zero, kind, halo_index(x, y, z)), counts);
    });
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

SurveyedSurface survey_surface(const WarpedLattice& lattice,
                               const StuffedBrick& kept) noexcept {
  SurveyedSurface found;
  const NodesNear nodes(lattice.plus, lattice.zero);
  found.counts.triangles = count_triangles(nodes);
  found.counts.vertices = count_cut_points(kept);
  count_zeros(lattice, kept, nodes, found.counts);
  found.sheet = surface_sheet({lattice.plus, lattice.zero});
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
