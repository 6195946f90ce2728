#include "core/surface/winding_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr std::size_t kLeafTriangles = 8;

/// A node is far from points beyond so many of its radii.
constexpr double kFarRadii = 3;

/// Beyond so many triangles the halves of a node are built side by side.
constexpr std::size_t kParallelTriangles = 4096;

/// Twice the solid angle's tangent formula of van Oosterom and Strackee (1983).
double solid_angle(const std::array<WorldPoint, 3>& corner, const WorldPoint& p) noexcept {
  const Vector a = from_to(p, corner[0]), b = from_to(p, corner[1]), c = from_to(p, corner[2]);
  const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
  const double volume = dot(a, cross(b, c));
  // On the triangle's plane the angle is 0 or, within the triangle, of either sign: none then.
  if (!(std::abs(volume) > 1e-12 * la * lb * lc)) return 0;
  const double scale = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(volume, scale);
}

Vector area_vector(const std::array<WorldPoint, 3>& corner) noexcept {
  const Vector n = cross(from_to(corner[0], corner[1]), from_to(corner[0], corner[2]));
  return {n.x / 2, n.y / 2, n.z / 2};
}

WorldPoint middle(const std::array<WorldPoint, 3>& c) noexcept {
  return {(c[0].x + c[1].x + c[2].x) / 3, (c[0].y + c[1].y + c[2].y) / 3,
          (c[0].z + c[1].z + c[2].z) / 3};
}

double coordinate(const WorldPoint& p, int axis) noexcept {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
  WorldPoint min{kInfinity, kInfinity, kInfinity}, max{-kInfinity, -kInfinity, -kInfinity};

  void add(const WorldPoint& p) noexcept {
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
  }
  int longest_axis() const noexcept {
    const Vector e = from_to(min, max);
    if (e.x >= e.y && e.x >= e.z) return 0;
    return e.y >= e.z ? 1 : 2;
  }
  /// The squared distance from `p` to the farthest corner.
  double reach_squared(const WorldPoint& p) const noexcept {
    const Vector far{std::max(p.x - min.x, max.x - p.x), std::max(p.y - min.y, max.y - p.y),
                     std::max(p.z - min.z, max.z - p.z)};
    return dot(far, far);
  }
};

void add_moment(std::array<double, 9>& moment, const Vector& at, const Vector& area) noexcept {
  const std::array<double, 3> u{at.x, at.y, at.z}, v{area.x, area.y, area.z};
  for (std::size_t i = 0; i < 9; ++i) moment[i] += u[i / 3] * v[i % 3];
}

}  // namespace

/// Splits at medians: a node of n leaves has 2n - 1 nodes below and with itself, so each has
/// its place before it is made.
struct WindingTree::Build {
  const TriangleSurface& surface;
  WindingTree& tree;
  std::vector<WorldPoint> centres;  // by triangle
  std::vector<std::uint32_t> order;

  std::array<WorldPoint, 3> corners(std::uint32_t t) const {
    const auto& ids = surface.triangles[t];
    return {surface.vertices[ids[0]], surface.vertices[ids[1]], surface.vertices[ids[2]]};
  }

  void split(std::size_t first, std::size_t middle, std::size_t last) {
    Box box;
    for (std::size_t i = first; i < last; ++i) box.add(centres[order[i]]);
    const int axis = box.longest_axis();
    const auto at = [&](std::size_t i) {
      return order.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t a, std::uint32_t b) {
      const double x = coordinate(centres[a], axis), y = coordinate(centres[b], axis);
      return x < y || (x == y && a < b);
    });
  }

  /// Returns the box of the node's triangles.
  Box make(std::size_t node, std::size_t first, std::size_t last) {
    Node& made = tree.nodes_[node];
    made.first = static_cast<std::uint32_t>(first);
    made.last = static_cast<std::uint32_t>(last);
    const std::size_t leaves = (last - first + kLeafTriangles - 1) / kLeafTriangles;
    if (leaves <= 1) return make_leaf(made);
    const std::size_t left_leaves = leaves / 2, half = first + left_leaves * kLeafTriangles;
    const std::size_t left = node + 1, right = node + 2 * left_leaves;
    made.right = static_cast<std::uint32_t>(right);
    split(first, half, last);
    Box left_box, right_box;
    const auto make_left = [&] { left_box = make(left, first, half); };
    const auto make_right = [&] { right_box = make(right, half, last); };
    if (last - first > kParallelTriangles) {
      run_side_by_side(make_left, make_right);
    } else {
      make_left();
      make_right();
    }
    return join(made, left, right, left_box, right_box);
  }

  Box make_leaf(Node& leaf) {
    Box box;
    double total = 0;
    WorldPoint sum;
    for (std::size_t i = leaf.first; i < leaf.last; ++i) {
      const auto corner = corners(order[i]);
      tree.triangles_[i] = {corner};
      for (const WorldPoint& p : corner) box.add(p);
      const Vector n = area_vector(corner);
      const double area = std::sqrt(dot(n, n));
      const WorldPoint at = middle(corner);
      leaf.area = {leaf.area.x + n.x, leaf.area.y + n.y, leaf.area.z + n.z};
      sum = {sum.x + area * at.x, sum.y + area * at.y, sum.z + area * at.z};
      total += area;
    }
    leaf.size = total;
    leaf.centre = total > 0 ? WorldPoint{sum.x / total, sum.y / total, sum.z / total} : box.min;
    for (std::size_t i = leaf.first; i < leaf.last; ++i) {
      const auto& corner = tree.triangles_[i].corner;
      add_moment(leaf.moment, from_to(leaf.centre, middle(corner)), area_vector(corner));
    }
    leaf.far_squared = kFarRadii * kFarRadii * box.reach_squared(leaf.centre);
    return box;
  }

  Box join(Node& node, std::size_t left, std::size_t right, Box box, const Box& other) const {
    box.add(other.min);
    box.add(other.max);
    const Node &a = tree.nodes_[left], &b = tree.nodes_[right];
    node.size = a.size + b.size;
    const double part = node.size > 0 ? b.size / node.size : 0;
    const Vector way = from_to(a.centre, b.centre);
    node.centre = {a.centre.x + part * way.x, a.centre.y + part * way.y,
                   a.centre.z + part * way.z};
    node.area = {a.area.x + b.area.x, a.area.y + b.area.y, a.area.z + b.area.z};
    for (std::size_t i = 0; i < 9; ++i) node.moment[i] = a.moment[i] + b.moment[i];
    add_moment(node.moment, from_to(node.centre, a.centre), a.area);
    add_moment(node.moment, from_to(node.centre, b.centre), b.area);
    node.far_squared = kFarRadii * kFarRadii * box.reach_squared(node.centre);
    return box;
  }
};

WindingTree::WindingTree(const TriangleSurface& surface) {
  const std::size_t count = surface.triangles.size();
  if (count == 0) return;
  nodes_.resize(2 * ((count + kLeafTriangles - 1) / kLeafTriangles) - 1);
  triangles_.resize(count);
  Build build{surface, *this, std::vector<WorldPoint>(count),
              std::vector<std::uint32_t>(count)};
  std::iota(build.order.begin(), build.order.end(), 0U);
  for_each_index(
      count,
      [&](std::size_t t) {
        build.centres[t] = middle(build.corners(static_cast<std::uint32_t>(t)));
      },
      1024);
  build.make(0, 0, count);
}

double WindingTree::far_part(const Node& node, const WorldPoint& p) noexcept {
  const Vector r = from_to(p, node.centre);
  const double squared = dot(r, r), inverse = 1 / (squared * std::sqrt(squared));
  const auto& m = node.moment;
  const double along = r.x * (m[0] * r.x + m[1] * r.y + m[2] * r.z) +
                       r.y * (m[3] * r.x + m[4] * r.y + m[5] * r.z) +
                       r.z * (m[6] * r.x + m[7] * r.y + m[8] * r.z);
  return inverse * (dot(r, node.area) + m[0] + m[4] + m[8] - 3 * along / squared);
}

double WindingTree::near_part(const Node& node, const WorldPoint& p) const noexcept {
  double angle = 0;
  for (std::size_t i = node.first; i < node.last; ++i) {
    angle += solid_angle(triangles_[i].corner, p);
  }
  return angle;
}

double WindingTree::at(const WorldPoint& p) const noexcept {
  if (nodes_.empty()) return 0;
  // Medians halve: 32-bit ids make the tree 32 levels deep at most.
  std::array<std::uint32_t, 64> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  double angle = 0;
  while (count > 0) {
    const std::uint32_t i = waiting[--count];
    const Node& node = nodes_[i];
    const Vector r = from_to(p, node.centre);
    if (dot(r, r) > node.far_squared) {
      angle += far_part(node, p);
    } else if (node.right == 0) {
      angle += near_part(node, p);
    } else {
      waiting[count++] = node.right;
      waiting[count++] = i + 1;
    }
  }
  return angle / (4 * M_PI);
}

double exact_winding_number(const TriangleSurface& surface, const WorldPoint& p) noexcept {
  double angle = 0;
  for (const auto& t : surface.triangles) {
    angle += solid_angle(
        {surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]}, p);
  }
  return angle / (4 * M_PI);
}

}  // namespace tet
