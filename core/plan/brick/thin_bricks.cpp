#include "core/plan/brick/thin_bricks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>

#include "core/base/brick_index.h"
#include "core/field/find_bricks.h"
#include "core/volume/volume.h"

namespace tet {
namespace {

/// Cells that a wall needs across it until nothing of it is reported, whichever way it is
/// tilted: its free edges, half as wide as itself, ask for more than its faces do.
constexpr double kCellsAcross = 2.5;

/// Spots of one group of bricks; nodes in doubled lattice coordinates.
struct Group {
  std::array<std::int64_t, 3> min{INT64_MAX, INT64_MAX, INT64_MAX};
  std::array<std::int64_t, 3> max{INT64_MIN, INT64_MIN, INT64_MIN};
  std::uint64_t inside = 0, outside = 0;

  void add(const ThinBrick& thin) noexcept {
    constexpr std::int64_t kBrick = 2 * kBrickEdge;
    const ThinSpots& s = thin.spots;
    const std::array<std::int64_t, 3> origin{kBrick * thin.brick.x, kBrick * thin.brick.y,
                                             kBrick * thin.brick.z};
    const std::array<std::int64_t, 3> low{s.min.x, s.min.y, s.min.z};
    const std::array<std::int64_t, 3> high{s.max.x, s.max.y, s.max.z};
    for (std::size_t i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], origin[i] + low[i]);
      max[i] = std::max(max[i], origin[i] + high[i]);
    }
    inside += s.inside;
    outside += s.outside;
  }
};

/// Gives every brick the first brick of its group: bricks that touch, if only at a corner,
/// belong together.
std::vector<std::size_t> find_groups(const std::vector<ThinBrick>& bricks) {
  std::vector<BrickCoord> coords;
  coords.reserve(bricks.size());
  for (const ThinBrick& thin : bricks) coords.push_back(thin.brick);
  const BrickIndex index(coords);
  std::vector<std::size_t> leader(bricks.size());
  std::iota(leader.begin(), leader.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    const BrickCoord b = coords[i];
    for_each_brick({{b.x - 1, b.y - 1, b.z - 1}, {b.x + 1, b.y + 1, b.z + 1}},
                   [&](BrickCoord around) {
                     const std::uint32_t at = index.find(around);
                     if (at == kNoBrick) return;
                     const std::size_t one = find(i), other = find(at);
                     leader[std::max(one, other)] = std::min(one, other);
                   });
  }
  for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = find(i);
  return leader;
}

/// Sorted by spots, most first; equal ones in the order of their bricks.
std::vector<Group> gather_groups(const std::vector<ThinBrick>& bricks) {
  const std::vector<std::size_t> leader = find_groups(bricks);
  std::vector<Group> groups(bricks.size());
  for (std::size_t i = 0; i < bricks.size(); ++i) groups[leader[i]].add(bricks[i]);
  std::erase_if(groups, [](const Group& g) { return g.inside + g.outside == 0; });
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.inside + a.outside > b.inside + b.outside;
  });
  return groups;
}

/// The chords of all spots, in spacings.
class Chords {
 public:
  explicit Chords(const std::vector<ThinBrick>& bricks) {
    for (const ThinBrick& thin : bricks) {
      for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        bins_[bin] += thin.spots.chords[bin];
        spots_ += thin.spots.chords[bin];
      }
    }
  }

  /// The chord that one in `one_in` spots does not reach.
  double quantile(std::uint64_t one_in) const {
    std::size_t bin = 0;
    for (std::uint64_t before = bins_[0]; before * one_in <= spots_; before += bins_[bin])
      ++bin;
    return (static_cast<double>(bin) + 0.5) / ThinSpots::kBinsPerSpacing;
  }

  /// The thickness of the walls that the spots lie in; 0 where they tell of none.
  ///
  /// Chords in walls are about as long as the walls are thick. At a sharp edge, or where two
  /// surfaces touch, they are of any length down to nothing, and at a finer spacing the same is
  /// seen on a smaller scale. Few spots tell neither.
  double wall() const {
    constexpr std::uint64_t kFewSpots = 48;
    const double quarter = quantile(4);
    return spots_ >= kFewSpots && quantile(20) >= quarter / 2 ? quarter : 0;
  }

 private:
  std::array<std::uint64_t, ThinSpots::kBins> bins_{};
  std::uint64_t spots_ = 0;
};

/// Reaches half a spacing beyond the spots' nodes.
WorldBox world_box(const Group& group, const VoxelTransform& lattice) {
  const auto low = [&](std::size_t i) { return 0.5 * static_cast<double>(group.min[i] - 1); };
  const auto high = [&](std::size_t i) { return 0.5 * static_cast<double>(group.max[i] + 1); };
  return lattice.to_world_box({low(0), low(1), low(2)}, {high(0), high(1), high(2)});
}

}  // namespace

ThinWalls gather_thin_walls(const std::vector<ThinBrick>& bricks,
                            const VoxelTransform& lattice) {
  ThinWalls walls;
  if (bricks.empty()) return walls;
  const std::vector<Group> groups = gather_groups(bricks);
  walls.region_count = groups.size();
  for (const Group& group : groups) {
    walls.inside += group.inside;
    walls.outside += group.outside;
  }
  const std::size_t listed = std::min(groups.size(), ThinWalls::kMaxRegions);
  for (const Group& group : std::span(groups).first(listed)) {
    walls.regions.push_back({world_box(group, lattice), group.inside, group.outside});
  }
  const Chords chords(bricks);
  walls.thickness = chords.quantile(4) * lattice.voxel_size;
  walls.suggested_spacing = chords.wall() * lattice.voxel_size / kCellsAcross;
  return walls;
}

}  // namespace tet
