#include "core/remap/linear_transfer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/parallel.h"
#include "core/mesh/space_curve.h"

namespace tet {
namespace {

/// Points of a run, which lie close together, are looked for one from the other: runs are cut
/// by number, not by thread.
constexpr std::size_t kPointsPerRun = 2048;

double longest_edge(const std::array<WorldPoint, 4>& t) noexcept {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const Vector edge = from_to(t[i], t[j]);
      longest = std::max(longest, dot(edge, edge));
    }
  }
  return std::sqrt(longest);
}

/// Calls `take(point number, place)` for every point, and says which were outside.
template <class Take>
Outside locate_all(const TetLocator& locator,
                   const std::vector<WorldPoint>& points,
                   const Take& take) {
  const std::vector<std::uint32_t> order = order_along_curve(points);
  std::vector<Outside> runs((points.size() + kPointsPerRun - 1) / kPointsPerRun);
  for_each_index(runs.size(), [&](std::size_t r) {
    std::optional<std::uint32_t> last;
    const std::size_t end = std::min(points.size(), (r + 1) * kPointsPerRun);
    for (std::size_t k = r * kPointsPerRun; k < end; ++k) {
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

CornerShares usable_shares(const TetLocator& locator, const TetLocator::Place& place) noexcept {
  if (!place.outside) return place.shares;
  const bool is_near =
      place.distance <= longest_edge(locator.mesh().places(place.tet)) &&
      std::isfinite(place.shares[0] + place.shares[1] + place.shares[2] + place.shares[3]);
  if (is_near) return place.shares;
  CornerShares nearest{};
  nearest[static_cast<std::size_t>(std::ranges::max_element(place.shares) -
                                   place.shares.begin())] = 1;
  return nearest;
}

Table sample_at_points(const TetLocator& locator,
                       const Table& corners,
                       const std::vector<WorldPoint>& points,
                       bool clamp,
                       Outside& outside) {
  Table found{corners.width, std::vector<double>(points.size() * corners.width)};
  outside = locate_all(locator, points, [&](std::size_t i, const TetLocator::Place& place) {
    const CornerShares shares = usable_shares(locator, place);
    const auto& [a, b, c, d] = locator.mesh().tets[place.tet];
    const auto va = corners.row(a), vb = corners.row(b), vc = corners.row(c),
               vd = corners.row(d);
    const auto row = found.row(i);
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k] = shares[0] * va[k] + shares[1] * vb[k] + shares[2] * vc[k] + shares[3] * vd[k];
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
                   Outside& outside) {
  Table found{cells.width, std::vector<double>(points.size() * cells.width)};
  outside = locate_all(locator, points, [&](std::size_t i, const TetLocator::Place& place) {
    std::ranges::copy(cells.row(place.tet), found.row(i).begin());
  });
  return found;
}

}  // namespace tet
