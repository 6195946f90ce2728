#include "core/field/find_bricks.h"

#include <algorithm>
#include <atomic>
#include <cstddef>

#include <gtest/gtest.h>

#include "core/base/own_threads.h"
#include "core/volume/volume_builder.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

PhiField grid_field(const Volume& volume, double spacing_voxels = 1) {
  PhiField field;
  field.volume = &volume;
  field.spacing_voxels = spacing_voxels;
  return field;
}

TEST(FindBricks, SeesTheSurfaceBetweenATileAndTheBackground) {
  // No brick has values of its own: the surface lies between constants alone.
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  builder.add_constant_cube({128, -128, 0}, 128, -1);
  const Volume tile = *std::move(builder).build();
  const auto found = find_bricks(grid_field(tile));
  ASSERT_TRUE(found.ok()) << found.status();
  // A layer of bricks on either side of the cube's faces: 18^3 less the 14^3 deep inside.
  EXPECT_EQ(found->near_surface.size(), 18U * 18 * 18 - 14 * 14 * 14);
  EXPECT_TRUE(std::is_sorted(found->near_surface.begin(), found->near_surface.end()));
  EXPECT_DOUBLE_EQ(found->inside_cells, 128.0 * 128 * 128);
}

TEST(FindBricks, SeesATileThatSpansRegionsAsOne) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  builder.add_constant_cube({-128, 0, 0}, 128, -1);
  builder.add_constant_cube({0, 0, 0}, 128, -1);
  const Volume tiles = *std::move(builder).build();
  const auto found = find_bricks(grid_field(tiles));
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->near_surface.size(), 34U * 18 * 18 - 30 * 14 * 14);
}

TEST(FindBricks, SeesALargeTileAsItsShellAndWhatLiesDeepInIt) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  builder.add_constant_cube({0, 0, -4096}, 4096, -1);
  const Volume tile = *std::move(builder).build();
  const auto found = find_bricks(grid_field(tile));
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->near_surface.size(), 514U * 514 * 514 - 510U * 510 * 510);
  EXPECT_DOUBLE_EQ(found->inside_cells, 4096.0 * 4096 * 4096);
}

TEST(FindBricks, RefusesTilesWithTooMuchSurfaceWithoutListingIt) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  constexpr int kTiles = 80;  // a few kilobytes of a file, 5e12 voxels
  for (int i = 0; i < kTiles; ++i) {
    builder.add_constant_cube({8192 * (i % 5), 8192 * (i / 5 % 5), 8192 * (i / 25)}, 4096, -1);
  }
  const Volume tiles = *std::move(builder).build();
  for (const double spacing : {1.0, 0.3, 1e-6}) {
    const auto found = find_bricks(grid_field(tiles, spacing));
    EXPECT_EQ(found.status().code(), absl::StatusCode::kResourceExhausted) << spacing;
  }
}

TEST(FindBricks, RefusesTilesThatClaimTooManyRegions) {
  VolumeBuilder large(VolumeKind::kLevelSet, 1), scattered(VolumeKind::kLevelSet, 1);
  for (int i = 0; i < 90; ++i) large.add_constant_cube({8192 * i, 0, 0}, 4096, -1);
  for (int i = 0; i < 40'000; ++i) {  // each with 26 regions around it
    scattered.add_constant_cube({512 * (i / 200), 512 * (i % 200), 0}, 128, -1);
  }
  for (VolumeBuilder* builder : {&large, &scattered}) {
    const Volume tiles = *std::move(*builder).build();
    const absl::Status status = find_bricks(grid_field(tiles)).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
  }
}

TEST(FindBricks, StopsOnceItIsCancelled) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  builder.add_constant_cube({0, 0, 0}, 128, -1);
  const Volume tile = *std::move(builder).build();
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_EQ(find_bricks(grid_field(tile), kMaxSurfaceBricks, cancelled).status().code(),
            absl::StatusCode::kCancelled);
}

/// How often finding the bricks of a volume looks at whether it is cancelled, in one thread.
std::size_t looks_at(const Volume& volume, double spacing, std::size_t most_bricks) {
  std::atomic<std::size_t> looks = 0;
  const Cancellation counted(Cancellation::Clock::time_point::max(), [&] {
    ++looks;
    return false;
  });
  run_with_own_threads(1, [&] {
    static_cast<void>(find_bricks(grid_field(volume, spacing), most_bricks, counted));
  });
  return looks;
}

/// A cube of 8^3 regions, each a constant: 10^3 have to be looked at, and the surface reaches
/// into all but those deep inside.
Volume cube_of_regions() {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  for (int i = 0; i < 512; ++i) {
    builder.add_constant_cube({128 * (i % 8), 128 * (i / 8 % 8), 128 * (i / 64)}, 128, -1);
  }
  return *std::move(builder).build();
}
constexpr std::size_t kRegionsLookedAt = 1000, kRegionsAtSurface = 1000 - 6 * 6 * 6;

TEST(FindBricks, LooksWhetherItIsCancelledBetweenFewRegionsAndBricks) {
  const Volume cube = cube_of_regions();
  // One for each region that is looked at, and one for each whose bricks are listed.
  EXPECT_GT(looks_at(cube, 1, kMaxSurfaceBricks), kRegionsLookedAt + kRegionsAtSurface);
  // On a finer lattice each brick of voxels several times, slice by slice.
  constexpr std::size_t kSurfaceBricks = 130 * 130 * 130 - 126 * 126 * 126;
  EXPECT_GT(looks_at(cube, 0.9, kMaxSurfaceBricks), 2 * kSurfaceBricks);
}

TEST(FindBricks, StopsSoonAfterThereIsTooMuchSurface) {
  // A refusal lists no bricks, and looks at few regions more than it takes to know.
  constexpr std::size_t kFewRegions = 80;
  const Volume cube = cube_of_regions();
  const std::size_t all = looks_at(cube, 1, kMaxSurfaceBricks);
  const std::size_t refused = looks_at(cube, 1, 1000);
  EXPECT_GT(all, refused + kRegionsLookedAt - kFewRegions + kRegionsAtSurface);
}

TEST(FindBricks, SeesConstantBricksInsideARegion) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  builder.add_constant_brick({15, 3, 3}, -1);  // its neighbours lie in two regions
  const Volume brick = *std::move(builder).build();
  const auto found = find_bricks(grid_field(brick));
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->near_surface.size(), 27U);
}

TEST(FindBricks, MapsVoxelBricksToTheLattice) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  builder.add_constant_brick({0, 0, 0}, -1);
  const Volume brick = *std::move(builder).build();
  for (const double spacing : {0.5, 2.0, 3.7}) {
    const auto found = find_bricks(grid_field(brick, spacing));
    ASSERT_TRUE(found.ok()) << found.status();
    PhiSampler sampler(grid_field(brick, spacing));
    // Every lattice corner that is inside lies in a brick that is listed.
    for (int x = -20; x < 40; ++x) {
      const int y = 2, z = 2;
      if (!sampler.inside(x, y, z)) continue;
      const BrickCoord seen{x >> 3, y >> 3, z >> 3};
      EXPECT_TRUE(
          std::binary_search(found->near_surface.begin(), found->near_surface.end(), seen))
          << "spacing " << spacing << " corner " << x;
    }
  }
}

TEST(FindBricks, RefusesAnInsideWithoutEnd) {
  const Volume everywhere = *VolumeBuilder(VolumeKind::kLevelSet, -1).build();
  EXPECT_EQ(check_inside_ends(grid_field(everywhere)).code(),
            absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace tet
