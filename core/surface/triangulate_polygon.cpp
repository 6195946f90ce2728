#include "core/surface/triangulate_polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct FlatPoint {
  double x = 0, y = 0;
};

/// Twice the area of a triangle: positive when it is wound to the left.
double turn_of(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The sum of all corners' cross products (Newell): the normal, twice the area long.
Vector newell_normal(std::span<const WorldPoint> points) {
  Vector sum{};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vector n = cross(from_to(points[0], points[i]), from_to(points[0], points[i + 1]));
    sum = {sum.x + n.x, sum.y + n.y, sum.z + n.z};
  }
  return sum;
}

/// Drops the coordinate that the normal has most of; what is seen is wound to the left.
std::vector<FlatPoint> flattened(std::span<const WorldPoint> points, const Vector& normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  std::vector<FlatPoint> flat;
  flat.reserve(points.size());
  for (const WorldPoint& p : points) {
    FlatPoint q = z >= x && z >= y ? FlatPoint{p.x, p.y}
                  : y >= x         ? FlatPoint{p.z, p.x}
                                   : FlatPoint{p.y, p.z};
    const double largest = z >= x && z >= y ? normal.z : y >= x ? normal.y : normal.x;
    if (largest < 0) std::swap(q.x, q.y);
    flat.push_back(q);
  }
  return flat;
}

bool is_convex(const std::vector<FlatPoint>& points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (turn_of(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
  }
  // All turns to the left, but more than once around, is no convex polygon.
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (turn_of(points[0], points[i], points[i + 1]) < 0) return false;
  }
  return true;
}

std::vector<Triangle> fan(std::size_t corners) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 2; i < corners; ++i) triangles.push_back({0, i - 1, i});
  return triangles;
}

/// How often a polygon's corners are looked at, at most, divided by their number, before others
/// have less of the looks that they share. An outline of 30,000 corners takes hundreds, and a
/// spiral of as many 18,600; one that was made to take long would take the square of its
/// corners.
constexpr std::uint64_t kOwnLooks = std::uint64_t{1} << 15;

/// The corners that are left, in a ring; and all of them from left to right, so that whoever
/// looks for those in an ear looks at few.
class EarCutter {
 public:
  explicit EarCutter(const std::vector<FlatPoint>& points)
      : points_(points),
        next_(points.size()),
        previous_(points.size()),
        is_cut_(points.size()),
        by_x_(points.size()) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    std::iota(by_x_.begin(), by_x_.end(), std::size_t{0});
    std::ranges::sort(by_x_, {}, [&](std::size_t i) { return points[i].x; });
  }

  /// Gives no triangles where there is no ear to be found, or none in so many looks.
  std::vector<Triangle> cut(std::uint64_t most_looks) {
    std::vector<Triangle> triangles;
    std::size_t left = points_.size(), corner = 0, tried = 0;
    while (left > 3) {
      if (tried > left || looks_ >= most_looks) return {};
      if (!is_ear(corner)) {
        corner = next_[corner];
        ++tried;
        continue;
      }
      tried = 0;
      triangles.push_back(triangle_at(corner));
      is_cut_[corner] = 1;
      next_[previous_[corner]] = next_[corner];
      previous_[next_[corner]] = previous_[corner];
      // Two corners on, so that what is left does not become a fan of slivers.
      corner = next_[next_[corner]];
      --left;
    }
    triangles.push_back(triangle_at(corner));
    return triangles;
  }

  /// How often a corner was looked at.
  std::uint64_t looks() const noexcept { return looks_; }

 private:
  Triangle triangle_at(std::size_t corner) const {
    return {static_cast<std::uint32_t>(previous_[corner]), static_cast<std::uint32_t>(corner),
            static_cast<std::uint32_t>(next_[corner])};
  }

  bool is_ear(std::size_t corner) {
    const FlatPoint &a = points_[previous_[corner]], &b = points_[corner],
                    &c = points_[next_[corner]];
    ++looks_;
    const double turn = turn_of(a, b, c);
    // A corner in the line of its neighbours is cut off at once: it holds nothing.
    if (turn < 0) return false;
    if (turn == 0) return true;
    const auto [low, high] = std::minmax({a.x, b.x, c.x});
    const auto x_of = [&](std::size_t i) { return points_[i].x; };
    for (auto at = std::ranges::lower_bound(by_x_, low, {}, x_of);
         at != by_x_.end() && points_[*at].x <= high; ++at) {
      ++looks_;
      if (is_cut_[*at] != 0) continue;
      const FlatPoint& p = points_[*at];
      const bool at_corner = (p.x == a.x && p.y == a.y) || (p.x == b.x && p.y == b.y) ||
                             (p.x == c.x && p.y == c.y);
      if (at_corner) continue;
      if (turn_of(a, b, p) >= 0 && turn_of(b, c, p) >= 0 && turn_of(c, a, p) >= 0) return false;
    }
    return true;
  }

  const std::vector<FlatPoint>& points_;
  std::vector<std::size_t> next_, previous_;
  std::vector<std::uint8_t> is_cut_;
  std::vector<std::size_t> by_x_;
  std::uint64_t looks_ = 0;
};

}  // namespace

std::vector<Triangle> triangulate_polygon(std::span<const WorldPoint> points,
                                          std::uint64_t& spare_looks) {
  if (points.size() <= 3) return fan(points.size());
  const Vector normal = newell_normal(points);
  if (!(dot(normal, normal) > 0)) return fan(points.size());
  const std::vector<FlatPoint> flat = flattened(points, normal);
  if (is_convex(flat)) return fan(points.size());
  const std::uint64_t own_looks = kOwnLooks * points.size();
  EarCutter cutter(flat);
  std::vector<Triangle> triangles = cutter.cut(own_looks + spare_looks);
  if (cutter.looks() > own_looks) {
    spare_looks -= std::min(spare_looks, cutter.looks() - own_looks);
  }
  return triangles.empty() ? fan(points.size()) : triangles;
}

}  // namespace tet
