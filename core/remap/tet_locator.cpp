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
/// A longer walk costs more than the tree does.
constexpr int kLongestWalk = 32;

BoxTree tree_over(const DataMesh& mesh) {
  std::vector<WorldBox> boxes(mesh.tets.size());
  for_each_index(
      boxes.size(), [&](std::size_t i) { boxes[i] = box_around(mesh.places(i)); },
      kTetsPerRange);
  return BoxTree(boxes);
}

BoxTree tree_over(const DataMesh& mesh, const std::vector<BorderFace>& faces) {
  std::vector<WorldBox> boxes(faces.size());
  for_each_index(
      boxes.size(),
      [&](std::size_t i) {
        const auto [a, b, c] = places_of(mesh, faces[i]);
        boxes[i] = box_around({a, b, c, c});
      },
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

TetLocator::TetLocator(const DataMesh& mesh)
    : mesh_(mesh),
      neighbors_(find_neighbors(mesh)),
      tree_(tree_over(mesh)),
      border_(tree_over(mesh, neighbors_.border)) {}

TetLocator::Place TetLocator::find(const WorldPoint& p,
                                   std::optional<std::uint32_t> near) const {
  const Walk walked = near ? walk(p, *near) : Walk{};
  if (walked.found) return *walked.found;
  if (const std::optional<Place> place = look_up(p)) return *place;
  return nearest(p, walked.border);
}

/// Through the face that the point is the farthest beyond, each time.
TetLocator::Walk TetLocator::walk(const WorldPoint& p, std::uint32_t from) const noexcept {
  std::uint32_t tet = from;
  for (int step = 0; step < kLongestWalk; ++step) {
    const CornerShares shares = shares_of(mesh_.places(tet), p);
    const double least = least_of(shares);
    if (least >= kInside) return {Place{tet, shares}, {}};
    const auto corner =
        static_cast<std::uint32_t>(std::ranges::find(shares, least) - shares.begin());
    if (corner == shares.size()) break;  // numbers that are none: the tet is flat
    const std::uint32_t next = neighbors_.across[tet][corner];
    if (next == TetNeighbors::kNone) return {{}, BorderFace{tet, corner}};
    tet = next;
  }
  return {};
}

std::optional<TetLocator::Place> TetLocator::look_up(const WorldPoint& p) const {
  Place place;
  bool found = false;
  tree_.visit_touching({p, p}, [&](std::uint32_t tet) {
    place = {tet, shares_of(mesh_.places(tet), p)};
    found = least_of(place.shares) >= kInside;
    return !found;
  });
  if (!found) return std::nullopt;
  return place;
}

/// Nothing farther than the border's face that was seen is looked at.
TetLocator::Place TetLocator::nearest(const WorldPoint& p,
                                      const std::optional<BorderFace>& seen) const {
  const double to_seen = seen ? squared_distance(p, places_of(mesh_, *seen))
                              : std::numeric_limits<double>::infinity();
  const BoxTree::Nearest near = border_.nearest(
      p,
      [&](std::uint32_t face) {
        return squared_distance(p, places_of(mesh_, neighbors_.border[face]));
      },
      to_seen);
  const bool is_nearer = near.squared_distance < to_seen;
  const std::uint32_t tet = is_nearer ? neighbors_.border[near.box].tet
                            : seen    ? seen->tet
                                      : std::uint32_t{0};
  return {tet, shares_of(mesh_.places(tet), p), true,
          std::sqrt(is_nearer ? near.squared_distance : to_seen)};
}

}  // namespace tet
