#include "core/remap/tet_locator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/triangle_distance.h"

namespace tet {
namespace {

/// A share this little below zero is one of zero: the faces of tets leave no gaps.
constexpr double kInside = -1e-12;
constexpr std::size_t kTetsPerRange = 4096;

BoxTree tree_over(const DataMesh& mesh) {
  std::vector<WorldBox> boxes(mesh.tets.size());
  for_each_index(
      boxes.size(), [&](std::size_t i) { boxes[i] = box_around(mesh.places(i)); },
      kTetsPerRange);
  return BoxTree(boxes);
}

/// The square of the distance from a tet to a point outside: to the nearest of the faces that
/// have the point on their outer side, and of a flat tet to any.
double squared_distance_outside(const std::array<WorldPoint, 4>& t,
                                const WorldPoint& p) noexcept {
  const CornerShares shares = shares_of(t, p);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t corner = 0; corner < 4; ++corner) {
    if (shares[corner] >= 0) continue;
    const std::array<WorldPoint, 3> face{t[(corner + 1) % 4], t[(corner + 2) % 4],
                                         t[(corner + 3) % 4]};
    least = std::min(least, squared_distance(p, face));
  }
  return least;
}

}  // namespace

WorldBox box_around(const std::array<WorldPoint, 4>& t) noexcept {
  return {
      {std::min({t[0].x, t[1].x, t[2].x, t[3].x}), std::min({t[0].y, t[1].y, t[2].y, t[3].y}),
       std::min({t[0].z, t[1].z, t[2].z, t[3].z})},
      {std::max({t[0].x, t[1].x, t[2].x, t[3].x}), std::max({t[0].y, t[1].y, t[2].y, t[3].y}),
       std::max({t[0].z, t[1].z, t[2].z, t[3].z})}};
}

TetLocator::TetLocator(const DataMesh& mesh) : mesh_(mesh), tree_(tree_over(mesh)) {}

TetLocator::Place TetLocator::find(const WorldPoint& p, std::uint32_t hint) const {
  Place place;
  const auto lies_in = [&](std::uint32_t tet) {
    place = {tet, shares_of(mesh_.places(tet), p)};
    return least_of(place.shares) >= kInside;
  };
  if (lies_in(hint)) return place;
  bool found = false;
  tree_.visit_touching({p, p}, [&](std::uint32_t tet) {
    found = lies_in(tet);
    return !found;
  });
  return found ? place : nearest(p, hint);
}

/// Nothing farther than the hint is looked at.
TetLocator::Place TetLocator::nearest(const WorldPoint& p, std::uint32_t hint) const {
  const double to_hint = squared_distance_outside(mesh_.places(hint), p);
  const BoxTree::Nearest near = tree_.nearest(
      p, [&](std::uint32_t tet) { return squared_distance_outside(mesh_.places(tet), p); },
      to_hint);
  const bool is_nearer = near.squared_distance < to_hint;
  const std::uint32_t tet = is_nearer ? near.box : hint;
  return {tet, shares_of(mesh_.places(tet), p), true,
          std::sqrt(is_nearer ? near.squared_distance : to_hint)};
}

}  // namespace tet
