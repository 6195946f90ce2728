// What a grid of sizes marks, and how much of it is kept.
#include "core/octree/grid_marker.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/octree/cell_set.h"

namespace tet {
namespace {

constexpr BrickBox kWide{{-1024, -1024, -1024}, {1023, 1023, 1023}};

/// Cubes of 128 voxels in a row, each of which reaches into 33^3 cells of four spacings.
Volume row_of_cubes(int count) {
  Volume grid;
  grid.kind = VolumeKind::kField;
  for (int i = 0; i < count; ++i) grid.cubes.push_back({{128 * i - 4096, 0, 0}, 128, 2.0F});
  return grid;
}

double marked(const Volume& grid, double most) {
  const Cancellation never;
  GridMarker marker(VoxelTransform{}, kWide, 6, most, never);
  marker.mark(grid);
  return marker.marked();
}

TEST(GridMarker, MarksEachCellThatACubeReachesInto) {
  EXPECT_EQ(marked(row_of_cubes(1), 1e9), 33 * 33 * 33);
}

TEST(GridMarker, MarksCellsOfManyBricksAsOneByOne) {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int32_t> place(-200, 200);
  for (int i = 0; i < 30; ++i) {
    const VoxelCoord min{place(random), place(random), place(random)};
    const std::int32_t edge = 1 + i * i;
    Volume grid;
    grid.kind = VolumeKind::kField;
    grid.cubes.push_back({min, edge, 2.0F});
    const auto cells =
        [&](std::int32_t begin) {  // of four spacings; voxels have their place in the middle
          const auto cell = [](double at) { return std::floor(at / 4); };
          return cell(begin + edge - 0.5 - 1e-3) - cell(begin - 0.5 + 1e-3) + 1;
        };
    const double expected = cells(min.x) * cells(min.y) * cells(min.z);
    if (expected > 1 << 18) continue;  // these are looked at in another way
    EXPECT_EQ(marked(grid, 1e9), expected) << edge;
  }
}

TEST(GridMarker, LooksWhetherItIsToStopAtEachHalfMillionCells) {
  constexpr double kCellsOfVoxel = 64 * 64 * 64;  // of two spacings
  Volume grid;
  grid.kind = VolumeKind::kField;
  grid.transform.linear = {{{128, 0, 0}, {0, 128, 0}, {0, 0, 128}}};
  grid.transform.voxel_size = 128;
  grid.bricks = {{0, 0, 0}};
  grid.values.assign(kBrickCells, 1.0F);
  int looks = 0, last = std::numeric_limits<int>::max();
  const auto mark = [&] {
    looks = 0;
    const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                    [&] { return ++looks >= last; });
    GridMarker marker(VoxelTransform{}, kWide, 6, 1e9, cancellation);
    marker.mark(grid);
    return marker.marked();
  };
  EXPECT_GT(mark(), 400 * kCellsOfVoxel);
  EXPECT_GT(looks, 250) << "one for every two voxels";
  last = 10;
  EXPECT_LE(mark(), 2 * last * kCellsOfVoxel);
}

TEST(GridMarker, StopsOnceThereAreTooManyHoweverManyCubesThereAre) {
  constexpr double kMost = 5e5;
  const double found = marked(row_of_cubes(60), kMost);
  EXPECT_GT(found, kMost) << "so that whoever asked can tell";
  EXPECT_LT(found, 2 * kMost);
}

TEST(GridMarker, StopsOnceItIsCancelled) {
  Cancellation cancelled;
  cancelled.cancel();
  GridMarker marker(VoxelTransform{}, kWide, 6, 1e9, cancelled);
  marker.mark(row_of_cubes(60));
  EXPECT_EQ(marker.marked(), 0);
}

}  // namespace
}  // namespace tet
