#include "core/field/regions_to_scan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/brick_box.h"
#include "core/base/brick_sets.h"

namespace tet {
namespace {

/// Looking at a region costs microseconds, and a tile that claims many costs its file nothing;
/// as many as this are a solid cube of 13,000^3 voxels.
constexpr std::size_t kMaxTileRegions = std::size_t{1} << 20;

BrickCoord steps_from(BrickCoord region, BrickCoord steps) {
  return {region.x + Region::kEdgeBricks * steps.x, region.y + Region::kEdgeBricks * steps.y,
          region.z + Region::kEdgeBricks * steps.z};
}

/// A cube of constants in regions: its first one, and how many along each edge.
struct RegionCube {
  BrickCoord min;
  std::int32_t edge = 0;

  explicit RegionCube(const ConstantCube& cube)
      : min{cube.min.x / kBrickEdge, cube.min.y / kBrickEdge, cube.min.z / kBrickEdge},
        edge(cube.edge / (Region::kEdgeBricks * kBrickEdge)) {}

  bool single() const noexcept { return edge == 1; }
  /// How many regions there are in and around its outermost layer; a single region counts
  /// alone.
  double regions_around() const noexcept {
    return single() ? 1 : std::pow(edge + 2, 3) - std::pow(edge - 2, 3);
  }
  /// The regions that touch none beyond the cube; if there are none, the box's ends are
  /// crossed.
  BrickBox deep() const noexcept {
    const BrickCoord last = steps_from(min, {edge - 1, edge - 1, edge - 1});
    return {steps_from(min, {1, 1, 1}), {last.x - 1, last.y - 1, last.z - 1}};
  }
};

absl::Status check_tile_regions(double regions) {
  if (regions <= static_cast<double>(kMaxTileRegions)) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("the grid's constant tiles make %.0f regions or more of 128^3 voxels to "
                      "look at; at most %d can "
                      "be meshed",
                      regions, kMaxTileRegions));
}

/// A cube's outermost regions and all that touch one. What lies deeper sees the cube alone.
void add_around(const RegionCube& cube, std::vector<BrickCoord>& regions) {
  const auto is_deep = [&](std::int32_t i) { return i > 0 && i < cube.edge - 1; };
  const BrickBox around{{-1, -1, -1}, {cube.edge, cube.edge, cube.edge}};
  for_each_brick(around, [&](BrickCoord at) {
    if (is_deep(at.x) && is_deep(at.y) && is_deep(at.z)) return;
    regions.push_back(steps_from(cube.min, at));
  });
}

/// Regions that constant cubes give reason to look at; sorted, unique.
absl::StatusOr<std::vector<BrickCoord>> regions_of_cubes(const std::vector<ConstantCube>& cubes,
                                                         const Cancellation& cancellation) {
  double claimed = 0;
  std::vector<BrickCoord> single, around_large;
  for (const ConstantCube& constant : cubes) {
    const RegionCube cube(constant);
    claimed += cube.regions_around();
    if (auto status = check_tile_regions(claimed); !status.ok()) return status;
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
    if (cube.single()) {
      single.push_back(cube.min);
    } else {
      add_around(cube, around_large);
    }
  }
  sort_unique(single, cancellation);
  sort_unique(around_large, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  std::vector<BrickCoord> regions;
  // Far apart they have 26 others around each: too many are not made to be counted.
  std::ranges::set_union(with_neighbours(single, Region::kEdgeBricks, kMaxTileRegions),
                         around_large, std::back_inserter(regions));
  if (auto status = check_tile_regions(static_cast<double>(regions.size())); !status.ok()) {
    return status;
  }
  return regions;
}

}  // namespace

absl::StatusOr<std::vector<BrickCoord>> regions_to_scan(const PhiField& field,
                                                        const Cancellation& cancellation) {
  const auto of_cubes = regions_of_cubes(field.volume->cubes, cancellation);
  if (!of_cubes.ok()) return of_cubes.status();
  std::vector<BrickCoord> with_bricks;
  for (const Region& region : field.volume->regions) with_bricks.push_back(region.min);
  sort_unique(with_bricks, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  std::vector<BrickCoord> regions;
  std::ranges::set_union(with_neighbours(with_bricks, Region::kEdgeBricks), *of_cubes,
                         std::back_inserter(regions));
  return regions;
}

std::vector<BrickBox> deep_inside(const PhiField& field) {
  std::vector<BrickBox> boxes;
  for (const ConstantCube& cube : field.volume->cubes) {
    const RegionCube in_regions(cube);
    if (in_regions.edge > 2 && field.phi(cube.value) < 0) boxes.push_back(in_regions.deep());
  }
  return boxes;
}

}  // namespace tet
