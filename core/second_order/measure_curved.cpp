#include "core/second_order/measure_curved.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/mesh/tets_per_range.h"

namespace tet {

TenNodes nodes_of(const TetMesh& mesh, const MiddleNodes& middles, std::uint64_t tet) noexcept {
  TenNodes node;
  std::ranges::copy(mesh.view().stored_places(tet), node.begin());
  const auto middle = middles.of_tet(tet);
  for (std::size_t e = 0; e < 6; ++e) {
    node[4 + e] = middles.stored_position(mesh.header, middle[e]);
  }
  return node;
}

CurvedStats measure_curved(const TetMesh& mesh, const MiddleNodes& middles) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<CurvedStats> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t end = std::min(tets, (r + 1) * kTetsPerRange);
    for (std::uint64_t tet = r * kTetsPerRange; tet < end; ++tet) {
      const TenNodes node = nodes_of(mesh, middles, tet);
      const JacobianCoefficients coefficients = jacobian_coefficients(node);
      const Vector b = from_to(node[0], node[1]), c = from_to(node[0], node[2]),
                   d = from_to(node[0], node[3]);
      const double straight = dot(cross(b, c), d);
      double sum = 0;
      for (const double coefficient : coefficients) sum += coefficient;
      if (mesh.region(tet) == MeshRegion::kInside) ranges[r].volume += sum / (20 * 6);
      const double least = *std::ranges::min_element(coefficients);
      if (straight > 0) {
        ranges[r].least_jacobian_share =
            std::min(ranges[r].least_jacobian_share, least / straight);
      }
    }
  });
  CurvedStats all;
  for (const CurvedStats& range : ranges) {
    all.volume += range.volume;
    all.least_jacobian_share = std::min(all.least_jacobian_share, range.least_jacobian_share);
  }
  return all;
}

}  // namespace tet
