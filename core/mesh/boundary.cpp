#include "core/mesh/boundary.h"

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>

#include "core/base/union_find.h"

namespace tet {
namespace {

/// A bijection of 64 bits without visible pattern (splitmix64's finaliser).
std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// For every vertex, the XOR of the hashes of the faces around it, as seen from each tet: an
/// inner face is seen twice and cancels, so an inner vertex is left with zero. The other way
/// round, a boundary vertex is left with zero by accident only, once in 2^64.
std::vector<std::uint64_t> xor_faces_around_vertices(const TetMesh& mesh) {
  std::vector<std::uint64_t> accumulated(mesh.header.vertex_count);
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const auto tet = mesh.tet(i);
    std::array<std::uint64_t, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) corner[k] = mix(tet[k]);
    const std::uint64_t sum = corner[0] + corner[1] + corner[2] + corner[3];
    std::array<std::uint64_t, 4> face;  // opposite each corner; whatever the order of its own
    for (std::size_t k = 0; k < 4; ++k) face[k] = mix(sum - corner[k]);
    const std::uint64_t all = face[0] ^ face[1] ^ face[2] ^ face[3];
    for (std::size_t k = 0; k < 4; ++k) accumulated[tet[k]] ^= all ^ face[k];
  }
  return accumulated;
}

/// Every boundary face, and the few inner ones whose three vertices lie on the boundary.
std::vector<SortedFace> faces_between_boundary_vertices(const TetMesh& mesh) {
  const auto accumulated = xor_faces_around_vertices(mesh);
  std::vector<SortedFace> faces;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const auto tet = mesh.tet(i);
    std::array<bool, 4> on_boundary;
    for (std::size_t k = 0; k < 4; ++k) on_boundary[k] = accumulated[tet[k]] != 0;
    const auto count = std::count(on_boundary.begin(), on_boundary.end(), true);
    if (count < 3) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      if (count == 4 || !on_boundary[k]) faces.push_back(sort_face(face_of(tet, k)));
    }
  }
  return faces;
}

/// Renames the triangles' vertices to 0 .. count-1 and returns the count.
std::uint64_t renumber(std::vector<Triangle>& triangles, std::uint64_t vertex_count) {
  constexpr std::uint64_t kUnseen = std::numeric_limits<std::uint64_t>::max();
  std::vector<std::uint64_t> new_id(vertex_count, kUnseen);
  std::uint64_t seen = 0;
  for (Triangle& triangle : triangles) {
    for (std::uint64_t& vertex : triangle) {
      if (new_id[vertex] == kUnseen) new_id[vertex] = seen++;
      vertex = new_id[vertex];
    }
  }
  return seen;
}

/// Side `corner` of a triangle joins that corner to the next.
struct Side {
  std::uint64_t low = 0, high = 0;  ///< vertices
  std::size_t triangle = 0;
  std::uint8_t low_corner = 0, high_corner = 0;
};

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::uint8_t corner = 0; corner < 3; ++corner) {
      const auto next = static_cast<std::uint8_t>(corner == 2 ? 0 : corner + 1);
      const std::uint64_t a = triangles[t][corner], b = triangles[t][next];
      sides.push_back(a < b ? Side{a, b, t, corner, next} : Side{b, a, t, next, corner});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::tie(s.low, s.high, s.triangle) < std::tie(t.low, t.high, t.triangle);
  });
  return sides;
}

/// Walks the edges and unites the triangle corners that meet across them.
class CornerFans {
 public:
  CornerFans(std::size_t triangles, std::uint64_t vertices)
      : corners_(3 * triangles), vertices_(vertices), broken_(vertices) {}

  void add_edge(std::span<const Side> sides) {
    ++edges_;
    const Side& first = sides.front();
    vertices_.unite(first.low, first.high);
    if (sides.size() != 2) {
      ++non_manifold_edges_;
      broken_[first.low] = broken_[first.high] = true;
      return;
    }
    const Side& second = sides.back();
    corners_.unite(3 * first.triangle + first.low_corner,
                   3 * second.triangle + second.low_corner);
    corners_.unite(3 * first.triangle + first.high_corner,
                   3 * second.triangle + second.high_corner);
  }

  BoundaryTopology topology(const std::vector<Triangle>& triangles) {
    mark_vertices_of_several_fans(triangles);
    const auto signed_count = [](std::uint64_t n) { return static_cast<std::int64_t>(n); };
    return {.triangles = triangles.size(),
            .vertices = broken_.size(),
            .components = vertices_.sets(),
            .euler_characteristic = signed_count(broken_.size()) - signed_count(edges_) +
                                    signed_count(triangles.size()),
            .non_manifold_edges = non_manifold_edges_,
            .non_manifold_vertices =
                static_cast<std::uint64_t>(std::count(broken_.begin(), broken_.end(), true))};
  }

 private:
  /// With two triangles at every edge, each set of corners is one cycle around its vertex.
  void mark_vertices_of_several_fans(const std::vector<Triangle>& triangles) {
    std::vector<bool> seen(broken_.size());
    for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
      if (corners_.find(i) != i) continue;
      const std::uint64_t vertex = triangles[i / 3][i % 3];
      if (seen[vertex]) broken_[vertex] = true;
      seen[vertex] = true;
    }
  }

  UnionFind corners_, vertices_;
  std::vector<bool> broken_;  ///< non-manifold vertices
  std::uint64_t edges_ = 0, non_manifold_edges_ = 0;
};

}  // namespace

std::vector<Triangle> boundary_triangles(const TetMesh& mesh) {
  std::vector<SortedFace> faces = faces_between_boundary_vertices(mesh);
  std::sort(faces.begin(), faces.end());
  std::vector<Triangle> triangles;
  for (auto run = faces.begin(); run != faces.end();) {
    const auto end = std::find_if(
        run, faces.end(), [&](const SortedFace& f) { return f.vertices != run->vertices; });
    if (end - run == 1) triangles.push_back(run->triangle());
    run = end;
  }
  return triangles;
}

BoundaryTopology measure_topology(std::vector<Triangle> triangles, std::uint64_t vertex_count) {
  CornerFans fans(triangles.size(), renumber(triangles, vertex_count));
  const std::vector<Side> sides = sorted_sides(triangles);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].low == sides[begin].low &&
           sides[end].high == sides[begin].high) {
      ++end;
    }
    fans.add_edge(std::span(sides).subspan(begin, end - begin));
  }
  return fans.topology(triangles);
}

BoundaryTopology measure_boundary(const TetMesh& mesh) {
  return measure_topology(boundary_triangles(mesh), mesh.header.vertex_count);
}

}  // namespace tet
