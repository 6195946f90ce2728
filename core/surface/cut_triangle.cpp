#include "core/surface/cut_triangle.h"

#include <algorithm>
#include <cmath>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

/// A needle is longer than so many times its width, and than so many edges: halves of what is
/// not are up to five times as many as slices would be.
constexpr double kNeedle = 16;

WorldPoint on_way(const WorldPoint& from, const WorldPoint& to, double part) noexcept {
  const Vector way = from_to(from, to);
  return {from.x + part * way.x, from.y + part * way.y, from.z + part * way.z};
}

/// The square of the side from corner `i` on.
double squared_side(const CutTriangle& t, std::size_t i) noexcept {
  const Vector side = from_to(t[i], t[(i + 1) % 3]);
  return dot(side, side);
}

std::size_t longest_side(const CutTriangle& t) noexcept {
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (squared_side(t, i) > squared_side(t, longest)) longest = i;
  }
  return longest;
}

double doubled_area(const CutTriangle& t) noexcept {
  const Vector n = cross(from_to(t[0], t[1]), from_to(t[0], t[2]));
  return std::sqrt(dot(n, n));
}

}  // namespace

WorldPoint SlicedTriangle::low_end(double part) const noexcept { return on_way(a, b, part); }

WorldPoint SlicedTriangle::high_end(double part) const noexcept {
  return part <= top ? on_way(a, c, part / top) : on_way(b, c, (1 - part) / (1 - top));
}

double TriangleCutter::least_pieces(const CutTriangle& triangle) const noexcept {
  const double length = std::sqrt(squared_side(triangle, longest_side(triangle)));
  constexpr double kLargest = 0.867;  // the area of two equilateral ones
  return std::max({1.0, length / edge_, doubled_area(triangle) / (kLargest * edge_ * edge_)});
}

std::optional<SlicedTriangle> TriangleCutter::slices_of(const CutTriangle& t) const noexcept {
  const std::size_t longest = longest_side(t);
  const double squared = squared_side(t, longest), length = std::sqrt(squared);
  if (!(length > kNeedle * edge_)) return std::nullopt;
  const double width = doubled_area(t) / length;
  if (!(length > kNeedle * width)) return std::nullopt;
  const WorldPoint &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
  // The diagonals of a slice are no longer than an edge where it is narrow enough.
  const bool narrow = 2 * width * width < edge_ * edge_;
  const double step = narrow ? std::sqrt(edge_ * edge_ - width * width) : width;
  const double top = std::clamp(dot(from_to(a, c), from_to(a, b)) / squared, 0.0, 1.0);
  return SlicedTriangle{a,     b, c, top, static_cast<std::size_t>(std::ceil(length / step)),
                        narrow};
}

bool TriangleCutter::halve(const CutTriangle& t) {
  const std::size_t longest = longest_side(t);
  if (squared_side(t, longest) <= edge_ * edge_) return false;
  const WorldPoint &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
  const WorldPoint half = on_way(a, b, 0.5);
  waiting_.push_back({half, b, c});
  waiting_.push_back({a, half, c});
  return true;
}

}  // namespace tet
