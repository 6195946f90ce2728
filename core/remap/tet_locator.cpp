#include "core/remap/tet_locator.h"

#include <algorithm>
#include <cmath>
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
  return found ? place : nearest(p);
}

TetLocator::Place TetLocator::nearest(const WorldPoint& p) const {
  const BoxTree::Nearest near = tree_.nearest(p, [&](std::uint32_t tet) {
    const auto [a, b, c, d] = mesh_.places(tet);
    return std::min(std::min(squared_distance(p, {a, b, c}), squared_distance(p, {a, b, d})),
                    std::min(squared_distance(p, {a, c, d}), squared_distance(p, {b, c, d})));
  });
  return {near.box, shares_of(mesh_.places(near.box), p), true,
          std::sqrt(near.squared_distance)};
}

}  // namespace tet
