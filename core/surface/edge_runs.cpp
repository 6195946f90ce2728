#include "core/surface/edge_runs.h"

#include <algorithm>

namespace tet {

std::vector<SurfaceSide> sorted_sides(const TriangleSurface& surface) {
  std::vector<SurfaceSide> sides;
  sides.reserve(surface.triangles.size() * 3);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = v[i], b = v[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), a < b});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace tet
