#include "core/mesh/regions.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

double six_volumes(const TetMesh& mesh, std::uint64_t i) noexcept {
  const auto [a, b, c, d] = mesh.tet(i);
  const WorldPoint corner = mesh.stored_position(a);
  const Vector ab = from_to(corner, mesh.stored_position(b));
  const Vector ac = from_to(corner, mesh.stored_position(c));
  return dot(cross(ab, ac), from_to(corner, mesh.stored_position(d)));
}

}  // namespace

std::uint64_t count_tets(const TetMesh& mesh, MeshRegion region) noexcept {
  if (!mesh.header.has_regions) {
    return region == MeshRegion::kInside ? mesh.header.tet_count : 0;
  }
  const auto regions = mesh.regions.bytes();
  return static_cast<std::uint64_t>(
      std::count(regions.begin(), regions.end(), static_cast<std::byte>(region)));
}

double measure_volume(const TetMesh& mesh, MeshRegion region) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<double> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange, end = std::min(begin + kTetsPerRange, tets);
    for (std::uint64_t i = begin; i < end; ++i) {
      if (mesh.region(i) == region) ranges[r] += six_volumes(mesh, i);
    }
  });
  return std::accumulate(ranges.begin(), ranges.end(), 0.0) / 6;
}

}  // namespace tet
