#include "core/surface/outer_surface.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"

namespace tet {
namespace {

using CutTriangle = std::array<WorldPoint, 3>;

/// How far before and behind a piece is looked, in lengths of `edge`.
constexpr double kLook = 1e-3;

WorldPoint moved(const WorldPoint& p, const Vector& by, double times) {
  return {p.x + times * by.x, p.y + times * by.y, p.z + times * by.z};
}

double squared(const WorldPoint& a, const WorldPoint& b) {
  const Vector v = from_to(a, b);
  return dot(v, v);
}

/// Cuts one triangle, and keeps its outer pieces.
class Cutter {
 public:
  Cutter(const WindingTree& tree, double edge) : tree_(tree), edge_(edge) {}

  std::vector<CutTriangle> cut(const CutTriangle& triangle) {
    std::vector<CutTriangle> waiting{triangle}, kept;
    while (!waiting.empty()) {
      const CutTriangle t = waiting.back();
      waiting.pop_back();
      std::size_t longest = 0;
      for (std::size_t i = 1; i < 3; ++i) {
        if (length(t, i) > length(t, longest)) longest = i;
      }
      if (length(t, longest) <= edge_ * edge_) {
        if (is_outer(t)) kept.push_back(t);
        continue;
      }
      const WorldPoint &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
      const WorldPoint half = moved(a, from_to(a, b), 0.5);
      waiting.push_back({half, b, c});
      waiting.push_back({a, half, c});
    }
    return kept;
  }

 private:
  static double length(const CutTriangle& t, std::size_t i) {
    return squared(t[i], t[(i + 1) % 3]);
  }

  bool is_outer(const CutTriangle& t) const {
    const Vector n = cross(from_to(t[0], t[1]), from_to(t[0], t[2]));
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return false;
    const WorldPoint middle{(t[0].x + t[1].x + t[2].x) / 3, (t[0].y + t[1].y + t[2].y) / 3,
                            (t[0].z + t[1].z + t[2].z) / 3};
    const double step = kLook * edge_ / length;
    const bool front = tree_.at(moved(middle, n, step)) > kInsideWinding;
    const bool back = tree_.at(moved(middle, n, -step)) > kInsideWinding;
    return front != back;
  }

  const WindingTree& tree_;
  double edge_;
};

}  // namespace

TriangleSurface outer_surface(const TriangleSurface& surface,
                              const WindingTree& tree,
                              double edge) {
  std::vector<std::vector<CutTriangle>> kept(surface.triangles.size());
  for_each_index(kept.size(), [&](std::size_t i) {
    const auto& t = surface.triangles[i];
    kept[i] =
        Cutter(tree, edge)
            .cut({surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]});
  });
  TriangleSurface outer;
  for (const auto& pieces : kept) {
    for (const CutTriangle& piece : pieces) {
      const auto first = static_cast<std::uint32_t>(outer.vertices.size());
      outer.vertices.insert(outer.vertices.end(), piece.begin(), piece.end());
      outer.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return outer;
}

}  // namespace tet
