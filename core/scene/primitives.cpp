// Source of the distances to cylinder, cone, torus, capsule and box: Inigo Quilez,
// https://iquilezles.org/articles/distfunctions. The periodic surfaces' nodal equations: von
// Schnering and Nesper, Z. Phys. B 83 (1991).
#include "core/scene/primitives.h"

#include <algorithm>
#include <cmath>

#include "core/base/vector_clones.h"
#include "core/scene/waves.h"

namespace tet::scene {
namespace {

double length(double x, double y) noexcept { return std::sqrt(x * x + y * y); }
double length(double x, double y, double z) noexcept {
  return std::sqrt(x * x + y * y + z * z);
}

double larger(double a, double b) noexcept { return a > b ? a : b; }
double smaller(double a, double b) noexcept { return a < b ? a : b; }

/// Distance to a rectangle's corner region, from how far a point is beyond its two sides.
double beyond_sides(double x, double y) noexcept {
  return smaller(larger(x, y), 0.0) + length(larger(x, 0.0), larger(y, 0.0));
}

/// Calls `phi(x, y, z)` with each point in the leaf's own frame.
template <class Phi>
[[gnu::always_inline]] inline void fill(const Instruction& leaf,
                                        const Points& points,
                                        std::size_t count,
                                        Values& values,
                                        const Phi& phi) noexcept {
  const auto a = leaf.frame.linear;
  const auto t = leaf.frame.translation;
  const double scale = leaf.frame.scale;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = points.x[i], y = points.y[i], z = points.z[i];
    values.at[i] = scale * phi(a[0][0] * x + a[0][1] * y + a[0][2] * z + t[0],
                               a[1][0] * x + a[1][1] * y + a[1][2] * z + t[1],
                               a[2][0] * x + a[2][1] * y + a[2][2] * z + t[2]);
  }
}

/// size: radius.
TET_VECTOR_CLONES
void sphere(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  const double radius = leaf.size[0];
  fill(leaf, p, n, out, [=](double x, double y, double z) { return length(x, y, z) - radius; });
}

/// size: half edges of the box before it is rounded. The rounding is an offset.
TET_VECTOR_CLONES
void rounded_box(const Instruction& leaf,
                 const Points& p,
                 std::size_t n,
                 Values& out) noexcept {
  const double hx = leaf.size[0], hy = leaf.size[1], hz = leaf.size[2];
  fill(leaf, p, n, out, [=](double x, double y, double z) {
    const double dx = std::abs(x) - hx, dy = std::abs(y) - hy, dz = std::abs(z) - hz;
    return smaller(larger(dx, larger(dy, dz)), 0.0) +
           length(larger(dx, 0.0), larger(dy, 0.0), larger(dz, 0.0));
  });
}

/// size: radius, half the height.
TET_VECTOR_CLONES
void cylinder(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  const double radius = leaf.size[0], half_height = leaf.size[1];
  fill(leaf, p, n, out, [=](double x, double y, double z) {
    return beyond_sides(length(x, y) - radius, std::abs(z) - half_height);
  });
}

/// size: radius at the bottom, radius at the top, half the height.
TET_VECTOR_CLONES
void cone(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  const double bottom = leaf.size[0], top = leaf.size[1], half_height = leaf.size[2];
  const double slant_r = top - bottom, slant_z = 2 * half_height;
  const double per_square = 1 / (slant_r * slant_r + slant_z * slant_z);
  fill(leaf, p, n, out, [=](double x, double y, double z) {
    const double r = length(x, y);
    // To the nearer cap, and to the slanted side.
    const double cap_r = larger(r - (z < 0 ? bottom : top), 0.0);
    const double cap_z = std::abs(z) - half_height;
    const double along = ((r - bottom) * slant_r + (z + half_height) * slant_z) * per_square;
    const double on_side = smaller(larger(along, 0.0), 1.0);
    const double side_r = r - bottom - on_side * slant_r;
    const double side_z = z + half_height - on_side * slant_z;
    const double square =
        smaller(cap_r * cap_r + cap_z * cap_z, side_r * side_r + side_z * side_z);
    const bool inside = (side_r < 0) & (cap_z < 0);
    return (inside ? -1.0 : 1.0) * std::sqrt(square);
  });
}

/// size: radius of the circle, radius of the tube around it.
TET_VECTOR_CLONES
void torus(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  const double major = leaf.size[0], minor = leaf.size[1];
  fill(leaf, p, n, out,
       [=](double x, double y, double z) { return length(length(x, y) - major, z) - minor; });
}

/// size: radius, half the length.
TET_VECTOR_CLONES
void capsule(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  const double radius = leaf.size[0], half_length = leaf.size[1];
  fill(leaf, p, n, out, [=](double x, double y, double z) {
    return length(x, y, larger(std::abs(z) - half_length, 0.0)) - radius;
  });
}

/// The frame turns the normal to z and moves the plane to the origin.
TET_VECTOR_CLONES
void half_space(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  fill(leaf, p, n, out, [](double, double, double z) { return z; });
}

// Periodic surfaces: the frame makes a period 1, and its scale brings their steepest slope,
// sqrt(3) per radian, down to 1 per world unit.

TET_VECTOR_CLONES
void gyroid(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  fill(leaf, p, n, out, [](double x, double y, double z) {
    return sin_of_turns(x) * cos_of_turns(y) + sin_of_turns(y) * cos_of_turns(z) +
           sin_of_turns(z) * cos_of_turns(x);
  });
}

TET_VECTOR_CLONES
void schwarz_p(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  fill(leaf, p, n, out, [](double x, double y, double z) {
    return cos_of_turns(x) + cos_of_turns(y) + cos_of_turns(z);
  });
}

TET_VECTOR_CLONES
void diamond(const Instruction& leaf, const Points& p, std::size_t n, Values& out) noexcept {
  fill(leaf, p, n, out, [](double x, double y, double z) {
    return cos_of_turns(z) * sin_of_turns(x + y) + sin_of_turns(z) * cos_of_turns(x - y);
  });
}

}  // namespace

void evaluate_primitive(const Instruction& leaf,
                        const Points& points,
                        std::size_t count,
                        Values& values) noexcept {
  switch (leaf.op) {
    case Op::kSphere:
      return sphere(leaf, points, count, values);
    case Op::kRoundedBox:
      return rounded_box(leaf, points, count, values);
    case Op::kCylinder:
      return cylinder(leaf, points, count, values);
    case Op::kCone:
      return cone(leaf, points, count, values);
    case Op::kTorus:
      return torus(leaf, points, count, values);
    case Op::kCapsule:
      return capsule(leaf, points, count, values);
    case Op::kHalfSpace:
      return half_space(leaf, points, count, values);
    case Op::kGyroid:
      return gyroid(leaf, points, count, values);
    case Op::kSchwarzP:
      return schwarz_p(leaf, points, count, values);
    case Op::kDiamond:
      return diamond(leaf, points, count, values);
    default:
      return;
  }
}

}  // namespace tet::scene
