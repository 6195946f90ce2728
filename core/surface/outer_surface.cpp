#include "core/surface/outer_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/surface/cut_triangle.h"

namespace tet {
namespace {

/// How far before and behind a piece is looked, in lengths of `edge`.
constexpr double kLook = 1e-3;

/// Triangles that are cut, or counted, one after the other.
constexpr std::size_t kTrianglesPerRange = 64;

WorldPoint moved(const WorldPoint& p, const Vector& by, double times) {
  return {p.x + times * by.x, p.y + times * by.y, p.z + times * by.z};
}

bool is_outer(const CutTriangle& t, const WindingTree& tree, double edge) {
  const Vector n = cross(from_to(t[0], t[1]), from_to(t[0], t[2]));
  const double length = std::sqrt(dot(n, n));
  if (!(length > 0)) return false;
  const WorldPoint middle{(t[0].x + t[1].x + t[2].x) / 3, (t[0].y + t[1].y + t[2].y) / 3,
                          (t[0].z + t[1].z + t[2].z) / 3};
  const double step = kLook * edge / length;
  const bool front = tree.at(moved(middle, n, step)) > kInsideWinding;
  const bool back = tree.at(moved(middle, n, -step)) > kInsideWinding;
  return front != back;
}

CutTriangle places_of(const TriangleSurface& surface, std::size_t triangle) {
  const auto& t = surface.triangles[triangle];
  return {surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]};
}

absl::Status too_many_pieces(double pieces, double edge, double most) {
  return absl::ResourceExhaustedError(absl::StrFormat(
      "solids of the surface overlap, and its triangles would be cut into %.3g pieces of %.3g "
      "voxels; the limit is %.3g. Use larger voxels, or unite the solids first",
      pieces, edge, most));
}

/// How many pieces each triangle is cut into.
absl::StatusOr<std::vector<std::uint64_t>> count_pieces(const TriangleSurface& surface,
                                                        double edge,
                                                        std::uint64_t most_pieces) {
  const std::size_t triangles = surface.triangles.size();
  const double most =
      std::max(static_cast<double>(most_pieces), 2 * static_cast<double>(triangles));
  // What would take long to count is not.
  double least = 0;
  const TriangleCutter cutter(edge);
  for (std::size_t i = 0; i < triangles; ++i) {
    least += cutter.least_pieces(places_of(surface, i));
  }
  if (!(least <= most)) return too_many_pieces(least, edge, most);
  std::vector<std::uint64_t> count(triangles);
  for_each_range(triangles, kTrianglesPerRange, [&](std::size_t begin, std::size_t end) {
    TriangleCutter own(edge);
    for (std::size_t i = begin; i < end; ++i) {
      own.for_each_piece(places_of(surface, i), [&](const CutTriangle&) { ++count[i]; });
    }
  });
  const auto all = static_cast<double>(std::reduce(count.begin(), count.end()));
  if (all > most) return too_many_pieces(all, edge, most);
  return count;
}

}  // namespace

absl::StatusOr<TriangleSurface> outer_surface(const TriangleSurface& surface,
                                              const WindingTree& tree,
                                              double edge,
                                              std::uint64_t most_pieces) {
  const auto count = count_pieces(surface, edge, most_pieces);
  if (!count.ok()) return count.status();
  std::vector<std::vector<CutTriangle>> kept(surface.triangles.size());
  for_each_range(kept.size(), 1, [&](std::size_t begin, std::size_t end) {
    TriangleCutter cutter(edge);
    for (std::size_t i = begin; i < end; ++i) {
      kept[i].reserve((*count)[i]);
      cutter.for_each_piece(places_of(surface, i), [&](const CutTriangle& piece) {
        if (is_outer(piece, tree, edge)) kept[i].push_back(piece);
      });
    }
  });
  const std::size_t pieces =
      std::transform_reduce(kept.begin(), kept.end(), std::size_t{0}, std::plus<>(),
                            [](const auto& k) { return k.size(); });
  TriangleSurface outer;
  outer.vertices.reserve(3 * pieces);
  outer.triangles.reserve(pieces);
  for (auto& of_triangle : kept) {
    for (const CutTriangle& piece : of_triangle) {
      const auto first = static_cast<std::uint32_t>(outer.vertices.size());
      outer.vertices.insert(outer.vertices.end(), piece.begin(), piece.end());
      outer.triangles.push_back({first, first + 1, first + 2});
    }
    of_triangle = {};
  }
  return outer;
}

}  // namespace tet
