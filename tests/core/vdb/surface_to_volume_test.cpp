#include "core/vdb/surface_to_volume.h"

#include <cmath>
#include <csignal>
#include <limits>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/files/surface_file.h"
#include "core/vdb/load.h"
#include "core/volume/volume_reader.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

constexpr const char* kScannedBunny = "/usr/share/glmark2/models/bunny.obj";

/// An axis-aligned box from `low` to `high` on each axis; the last `missing` triangles left
/// out.
TriangleSurface box(double low, double high, std::size_t missing = 0) {
  TriangleSurface surface;
  for (int i = 0; i < 8; ++i) {
    surface.vertices.push_back(
        {(i & 1) != 0 ? high : low, (i & 2) != 0 ? high : low, (i & 4) != 0 ? high : low});
  }
  surface.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  surface.triangles.resize(12 - missing);
  return surface;
}

TEST(SurfaceToVolume, MeasuresTheDistanceToAClosedSurface) {
  const auto result = surface_to_volume(box(-1.03, 1.03), 0.1);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_TRUE(result->report.closed);
  EXPECT_EQ(result->report.triangles, 12U);
  EXPECT_THAT(result->report.text(), HasSubstr("closed surface (12 triangles, 8 vertices)"));
  EXPECT_EQ(result->volume.kind, VolumeKind::kLevelSet);
  EXPECT_FLOAT_EQ(result->volume.background, 0.3F);
  VolumeReader reader(result->volume);
  for (int x = -15; x <= 15; ++x) {
    const double phi = std::clamp(std::abs(x * 0.1) - 1.03, -0.3, 0.3);
    EXPECT_NEAR(reader.value({x, 0, 0}), phi, 1e-3) << x;
  }
}

TEST(SurfaceToVolume, MakesAShellOfAnOpenSurface) {
  const auto result = surface_to_volume(box(-1.03, 1.03, 2), 0.1);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_FALSE(result->report.closed);
  EXPECT_EQ(result->report.open_edges, 4U);
  EXPECT_THAT(result->report.text(), HasSubstr("4 open edges"));
  EXPECT_THAT(result->report.text(), HasSubstr("a shell two voxels thick"));
  EXPECT_FLOAT_EQ(result->volume.background, 0.3F);
  VolumeReader reader(result->volume);
  for (int x = -15; x <= 0; ++x) {
    const double distance = std::abs(std::abs(x * 0.1) - 1.03);
    EXPECT_NEAR(reader.value({x, 0, 0}), std::min(distance - 0.1, 0.3), 1e-3) << x;
  }
  EXPECT_FLOAT_EQ(reader.value({10, 0, 0}), 0.3F);  // where the side is missing
}

TEST(SurfaceToVolume, WritesWhatItWouldReturn) {
  const test::TestDirectory directory;
  const std::string path = directory.file("box.vdb");
  const auto report = surface_to_vdb(box(-1, 1), 0.1, path);
  ASSERT_TRUE(report.ok()) << report.status();
  const auto direct = surface_to_volume(box(-1, 1), 0.1);
  const auto loaded = load_volume(path, "surface");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->values, direct->volume.values);
  EXPECT_EQ(loaded->bricks, direct->volume.bricks);
  EXPECT_EQ(loaded->transform.voxel_size, 0.1);
  EXPECT_EQ(list_grids(path)->front().active_voxels, report->active_voxels);
  EXPECT_EQ(directory.file_count(), 1U);
}

TEST(SurfaceToVolume, ConvertsTheBunny) {
  const auto surface = read_surface(kScannedBunny);
  ASSERT_TRUE(surface.ok()) << surface.status();
  constexpr double kVoxel = 0.03;
  const auto result = surface_to_volume(*surface, kVoxel);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_TRUE(result->report.closed);
  EXPECT_GT(result->report.active_voxels, 10'000U);
  VolumeReader reader(result->volume);
  double distance = 0;
  for (const WorldPoint& v : surface->vertices) {
    distance += std::abs(reader.trilinear({v.x / kVoxel, v.y / kVoxel, v.z / kVoxel}));
  }
  EXPECT_LT(distance / static_cast<double>(surface->vertices.size()), 0.1 * kVoxel);
}

/// Boxes within boxes, all in one surface.
TriangleSurface nested(std::initializer_list<double> half_edges) {
  TriangleSurface all;
  for (const double half : half_edges) {
    const TriangleSurface one = box(-half, half);
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
    for (const auto& t : one.triangles) {
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  return all;
}

TEST(SurfaceToVolume, FillsWhatTheOutsideCannotReach) {
  const auto result = surface_to_volume(nested({1.53, 0.53}), 0.1);
  ASSERT_TRUE(result.ok()) << result.status();
  VolumeReader reader(result->volume);
  EXPECT_LT(reader.value({10, 0, 0}), 0);
  EXPECT_LT(reader.value({0, 0, 0}), 0);
  EXPECT_GT(reader.value({16, 0, 0}), 0);
}

TEST(SurfaceToVolume, RefusesVoxelSizesThatMakeNoSense) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const absl::Status status = surface_to_volume(box(-1, 1), bad).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("is not positive"));
  }
  EXPECT_THAT(surface_to_volume(box(0.1, 0.2), 1).status().message(),
              HasSubstr("voxel size 1 is too large"));
  EXPECT_THAT(surface_to_volume({}, 1).status().message(), HasSubstr("no triangle"));
}

TEST(SurfaceToVolume, RefusesAbsurdSizesBeforeTakingMemory) {
  const absl::Status fine = surface_to_volume(box(-1, 1), 1e-5).status();
  EXPECT_EQ(fine.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(fine.message(), HasSubstr("the limit is 1e+09"));
  const absl::Status far = surface_to_volume(box(1e9, 1e9 + 1), 0.1).status();
  EXPECT_EQ(far.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(far.message(), HasSubstr("the limit is 536870912"));
  EXPECT_FALSE(surface_to_volume(box(-1e300, 1e300), 1e-300).ok());
}

TEST(SurfaceToVdb, LeavesNothingBehindWhenItCannotWrite) {
  const test::TestDirectory directory;
  const absl::Status missing =
      surface_to_vdb(box(-1, 1), 0.1, directory.file("no/box.vdb")).status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(missing.message(), HasSubstr("No such file"));

  rlimit before;
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};  // as if the disk were full
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  test::write_bytes(directory.file("box.vdb"), "what was there");
  const absl::Status full = surface_to_vdb(box(-1, 1), 0.1, directory.file("box.vdb")).status();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(full.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(full.message(), HasSubstr("File too large"));
  EXPECT_EQ(directory.file_count(), 1U);
  EXPECT_EQ(test::read_bytes(directory.file("box.vdb")), "what was there");
}

}  // namespace
}  // namespace tet
