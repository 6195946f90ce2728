// Generalized winding numbers: how often a surface goes around a point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/tet_geometry.h"
#include "core/surface/triangle_surface.h"

namespace tet {

/// Triangles in a hierarchy of boxes, each with the moments of what it holds.
///
/// The winding number of a point is the sum of the solid angles of all triangles, over 4 pi: 1
/// within a closed surface that is wound outwards, 0 outside of it, and the number of solids
/// that hold the point where several overlap. Far groups of triangles count as one dipole and
/// its first correction, near ones exactly (Barill and others, "Fast Winding Numbers for Soups
/// and Clouds", SIGGRAPH 2018). Built once, in parallel; the same for any number of threads.
class WindingTree {
 public:
  explicit WindingTree(const TriangleSurface& surface);

  /// The winding number at `p`, off by a few hundredths at most. A triangle that `p` lies on
  /// counts for nothing: on a face of a solid the number is a half.
  double at(const WorldPoint& p) const noexcept;

 private:
  /// Triangles `first` to `last` of the order; children come behind: the left one at once.
  struct Node {
    WorldPoint centre;               ///< mean of its triangles, by area
    double size = 0;                 ///< their area
    double far_squared = 0;          ///< beyond this (squared distance to the centre) it is far
    Vector area{};                   ///< sum of the triangles' area vectors
    std::array<double, 9> moment{};  ///< sum of (triangle - centre) x (area vector), by rows
    std::uint32_t first = 0, last = 0;
    std::uint32_t right = 0;  ///< 0 for a leaf
  };
  struct Corners {
    std::array<WorldPoint, 3> corner;
  };
  struct Build;

  static double far_part(const Node& node, const WorldPoint& p) noexcept;
  double near_part(const Node& node, const WorldPoint& p) const noexcept;

  std::vector<Node> nodes_;
  std::vector<Corners> triangles_;  ///< in the order of the leaves
};

/// The sum itself, triangle by triangle.
double exact_winding_number(const TriangleSurface& surface, const WorldPoint& p) noexcept;

}  // namespace tet
