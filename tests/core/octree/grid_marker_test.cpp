// What a grid of sizes marks, and how much of it is kept.
#include "core/octree/grid_marker.h"

#include <cstddef>

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
