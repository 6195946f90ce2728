// The tets around one vertex, and how good they are wherever that vertex is put.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/base/dihedral.h"
#include "core/base/tet_geometry.h"
#include "core/base/types.h"
#include "core/mesh/improve/vertex_stars.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Dihedral angles that are good enough, and one number for how bad others are.
struct AngleGoal {
  AngleRange good;

  /// How bad a star's angles are: equal for angles at either end of the good ones, and more
  /// beyond.
  double cost(const AngleRange& angles) const noexcept {
    const double obtuse_weight = good.largest_cosine / good.smallest_cosine;
    return std::max(angles.largest_cosine, obtuse_weight * angles.smallest_cosine);
  }
  double good_cost() const noexcept { return good.largest_cosine; }
  bool met_by(const AngleRange& angles) const noexcept {
    return angles.largest_cosine <= good.largest_cosine &&
           angles.smallest_cosine >= good.smallest_cosine;
  }
};

/// What a move must stay within, in every tet of the star.
struct StarBound {
  AngleRange range;
  double cost = 0;
};

/// The star of a vertex without the vertex: the faces opposite it. Reused from vertex to
/// vertex.
class Star {
 public:
  explicit Star(const AngleGoal& goal) : goal_(goal) {}

  void gather(const TetMesh& mesh, std::span<const TetCorner> corners);

  /// Angles of all tets with their vertex at `middle`; puts the worst of them first.
  AngleRange angles(const WorldPoint& middle) noexcept;

  /// The cost with the vertex at `middle`; nothing when a tet is not positive or not within
  /// `bound`.
  std::optional<double> cost_below(const StarBound& bound, const WorldPoint& middle) noexcept;

  /// How the cost of the tet that `angles` found worst falls when its vertex moves from
  /// `middle`: minus its gradient, times `step`, over which it is differentiated.
  Vector descent(const WorldPoint& middle, double step) const noexcept;

 private:
  /// (middle, b, c, d) is positive.
  struct Face {
    WorldPoint b, c, d;
    Vector normal;      // towards the middle
    double per_square;  // 1 / |normal|^2

    AngleRange angles(const WorldPoint& middle) const noexcept;
  };

  AngleGoal goal_;
  std::vector<Face> faces_;
};

}  // namespace tet
