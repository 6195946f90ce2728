#include "core/remap/linear_transfer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "core/base/parallel.h"
#include "core/mesh/space_curve.h"

namespace tet {
namespace {

/// Points of a run, which lie close together, are looked for one from the other: runs are cut
/// by number, not by thread.
constexpr std::size_t kPointsPerRun = 2048;
/// A point may lie in the boxes of all tets, where these are long and cross each other.
constexpr std::size_t kPointsBetweenLooks = 16;

CornerShares all_of_nearest(const std::array<WorldPoint, 4>& t, const WorldPoint& p) noexcept {
  std::array<double, 4> squared{};
  std::ranges::transform(t, squared.begin(), [&](const WorldPoint& corner) {
    const Vector way = from_to(corner, p);
    return dot(way, way);
  });
  CornerShares nearest{};
  nearest[static_cast<std::size_t>(std::ranges::min_element(squared) - squared.begin())] = 1;
  return nearest;
}

/// Calls `take(point number, place)` for every point, and says which were outside. Once
/// cancelled for some.
template <class Take>
Outside locate_all(const TetLocator& locator,
                   const std::vector<WorldPoint>& points,
                   const Cancellation& cancellation,
                   const Take& take) {
  const std::vector<std::uint32_t> order = order_along_curve(points);
  std::vector<Outside> runs((points.size() + kPointsPerRun - 1) / kPointsPerRun);
  for_each_index(runs.size(), [&](std::size_t r) {
    std::optional<std::uint32_t> last;
    const std::size_t end = std::min(points.size(), (r + 1) * kPointsPerRun);
    for (std::size_t k = r * kPointsPerRun; k < end; ++k) {
      if (k % kPointsBetweenLooks == 0 && cancellation.requested()) return;
      const std::uint32_t i = order[k];
      const TetLocator::Place place = locator.find(points[i], last);
      last = place.tet;
      take(i, place);
      if (!place.outside) continue;
      ++runs[r].points;
      runs[r].farthest = std::max(runs[r].farthest, place.distance);
    }
  });
  Outside all;
  for (const Outside& run : runs) {
    all.points += run.points;
    all.farthest = std::max(all.farthest, run.farthest);
  }
  return all;
}

}  // namespace

CornerShares usable_shares(const TetLocator& locator,
                           const WorldPoint& p,
                           const TetLocator::Place& place) noexcept {
  if (!place.outside) return place.shares;
  const std::array<WorldPoint, 4> tet = locator.mesh().places(place.tet);
  const bool goes_on = place.distance <= longest_edge(tet) && !is_flat(tet);
  return goes_on ? place.shares : all_of_nearest(tet, p);
}

Table sample_at_points(const TetLocator& locator,
                       const Table& corners,
                       const std::vector<WorldPoint>& points,
                       bool clamp,
                       const Cancellation& cancellation,
                       Outside& outside) {
  Table found{corners.width, std::vector<double>(points.size() * corners.width)};
  outside = locate_all(
      locator, points, cancellation, [&](std::size_t i, const TetLocator::Place& place) {
        const CornerShares shares = usable_shares(locator, points[i], place);
        const auto& [a, b, c, d] = locator.mesh().tets[place.tet];
        const auto va = corners.row(a), vb = corners.row(b), vc = corners.row(c),
                   vd = corners.row(d);
        const auto row = found.row(i);
        for (std::size_t k = 0; k < row.size(); ++k) {
          row[k] =
              shares[0] * va[k] + shares[1] * vb[k] + shares[2] * vc[k] + shares[3] * vd[k];
          if (!clamp) continue;
          const auto [least, most] = std::minmax({va[k], vb[k], vc[k], vd[k]});
          row[k] = std::clamp(row[k], least, most);
        }
      });
  return found;
}

Table sample_cells(const TetLocator& locator,
                   const Table& cells,
                   const std::vector<WorldPoint>& points,
                   const Cancellation& cancellation,
                   Outside& outside) {
  Table found{cells.width, std::vector<double>(points.size() * cells.width)};
  outside = locate_all(locator, points, cancellation,
                       [&](std::size_t i, const TetLocator::Place& place) {
                         std::ranges::copy(cells.row(place.tet), found.row(i).begin());
                       });
  return found;
}

}  // namespace tet
