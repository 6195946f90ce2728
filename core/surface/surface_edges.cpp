#include "core/surface/surface_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace tet {
namespace {

/// Maps each vertex to the first of those that lie where it does.
std::vector<std::uint32_t> weld(const std::vector<WorldPoint>& vertices) {
  const auto key = [&](std::uint32_t i) {
    return std::tie(vertices[i].x, vertices[i].y, vertices[i].z);
  };
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tie(a)) < std::tuple_cat(key(b), std::tie(b));
  });
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::vector<Edge> sorted_edges(const TriangleSurface& surface) {
  const std::vector<std::uint32_t> first = weld(surface.vertices);
  std::vector<Edge> edges;
  edges.reserve(surface.triangles.size() * 3);
  for (const auto& triangle : surface.triangles) {
    const std::array<std::uint32_t, 3> v{first[triangle[0]], first[triangle[1]],
                                         first[triangle[2]]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax({v[i], v[(i + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

SurfaceEdges count_edges(const TriangleSurface& surface) {
  const std::vector<Edge> edges = sorted_edges(surface);
  SurfaceEdges count;
  for (auto run = edges.begin(); run != edges.end();) {
    const auto end = std::find_if(run, edges.end(), [&](const Edge& e) { return e != *run; });
    count.open += end - run == 1 ? 1 : 0;
    count.non_manifold += end - run > 2 ? 1 : 0;
    run = end;
  }
  return count;
}

}  // namespace tet
