#include "core/pipeline/boundary_count.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_index.h"
#include "core/base/parallel.h"
#include "core/base/union_find.h"

namespace tet {
namespace {

/// Parts that a link joins are one component.
std::uint64_t count_components(const Survey& survey) {
  const std::vector<std::uint64_t> first_part = offsets_from_counts(
      survey.parts.size(), [&](std::size_t i) { return std::uint64_t{survey.parts[i].count}; });
  const BrickIndex index(survey.bricks);
  UnionFind parts(first_part.back());
  for (std::size_t i = 0; i < survey.bricks.size(); ++i) {
    const BrickCoord b = survey.bricks[i];
    for (const SurfaceLink& link : survey.parts[i].links) {
      const std::uint32_t other =
          index.find({b.x + link.to_brick[0], b.y + link.to_brick[1], b.z + link.to_brick[2]});
      parts.unite(first_part[i] + link.part,
                  first_part[other] + survey.parts[other].part(link.element));
    }
  }
  return parts.sets();
}

}  // namespace

std::optional<BoundaryTopology> count_boundary(const Survey& survey) {
  if (survey.box_cuts_surface) return std::nullopt;
  const SurfaceCounts& surface = survey.surface;
  return BoundaryTopology{
      .triangles = surface.triangles,
      .vertices = surface.vertices,
      .components = count_components(survey),
      .euler_characteristic = surface.euler_characteristic(),
      .non_manifold_edges = surface.non_manifold_edges,
      .non_manifold_vertices = surface.non_manifold_vertices,
      .restored_nodes = survey.restored == nullptr ? 0 : survey.restored->count()};
}

}  // namespace tet
