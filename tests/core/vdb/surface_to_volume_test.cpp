#include "core/vdb/openvdb/surface_to_volume.h"

#include <cmath>
#include <csignal>
#include <limits>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/triangle_files/surface_file.h"
#include "core/vdb/openvdb/load.h"
#include "core/vdb/openvdb/write_volume.h"
#include "core/volume/volume_reader.h"
#include "tests/core/vdb/surface_trial.h"
#include "tests/support/surfaces.h"
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
  EXPECT_EQ(result->report.kind, ConvertedTo::kSolid);
  EXPECT_EQ(result->report.triangles, 12U);
  EXPECT_THAT(result->report.text(), HasSubstr("8 vertices, 12 triangles, closed;"));
  EXPECT_EQ(result->volume.kind, VolumeKind::kLevelSet);
  EXPECT_FLOAT_EQ(result->volume.background, 0.3F);
  VolumeReader reader(result->volume);
  for (int x = -15; x <= 15; ++x) {
    const double phi = std::clamp(std::abs(x * 0.1) - 1.03, -0.3, 0.3);
    EXPECT_NEAR(reader.value({x, 0, 0}), phi, 1e-3) << x;
  }
}

TEST(SurfaceToVolume, RefusesAnOpenSurfaceUnlessItIsToldWhatToMakeOfIt) {
  const auto open = box(-1.03, 1.03, 2);
  const absl::Status refused = surface_to_volume(open, 0.1).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(refused.message(), HasSubstr("4 open edges in 1 hole of up to 2.91"));
  EXPECT_THAT(refused.message(), HasSubstr("--open close"));
  const auto result = surface_to_volume(open, 0.1, OpenSurface::kClose);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->report.kind, ConvertedTo::kClosedSolid);
  EXPECT_NEAR(result->report.volume, std::pow(2.06, 3), 0.05);
  EXPECT_LT(VolumeReader(result->volume).value({9, 0, 0}), 0);
}

TEST(SurfaceToVolume, MakesAShellOfAnOpenSurface) {
  const auto result = surface_to_volume(box(-1.03, 1.03, 2), 0.1, OpenSurface::kShell);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->report.kind, ConvertedTo::kShell);
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
  EXPECT_EQ(result->report.kind, ConvertedTo::kSolid);
  EXPECT_THAT(result->report.warnings(), ::testing::IsEmpty());
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

TEST(SurfaceToVolume, CountsSolidsWithinSolidsAsOneAndSaysSo) {
  const auto result = surface_to_volume(nested({1.53, 0.53}), 0.1);
  ASSERT_TRUE(result.ok()) << result.status();
  VolumeReader reader(result->volume);
  EXPECT_LT(reader.value({10, 0, 0}), 0);
  EXPECT_LT(reader.value({0, 0, 0}), 0);
  EXPECT_GT(reader.value({16, 0, 0}), 0);
  EXPECT_TRUE(result->report.overlaps);
  EXPECT_THAT(result->report.text(), HasSubstr("count as one"));
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

TEST(SurfaceToVolume, RefusesVoxelSizesWhoseDistancesNoFloatHolds) {
  const auto scaled = [](double size) { return test::placed(box(-10, 10), size, {}); };
  for (const double bad : {1e-46, 9e-29, 1.1e28, 1e50}) {
    const absl::Status status = surface_to_volume(scaled(bad), bad).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_THAT(status.message(), HasSubstr("is not from 1e-28 to 1e+28"));
    EXPECT_THAT(status.message(), HasSubstr("use another unit of length"));
  }
  for (const double good : {1e-28, 1e28}) {
    const auto result = surface_to_volume(scaled(good), good);
    ASSERT_TRUE(result.ok()) << result.status();
    VolumeReader reader(result->volume);
    EXPECT_NEAR(static_cast<double>(reader.value({8, 0, 0})) / good, -2, 1e-3);
    EXPECT_NEAR(static_cast<double>(result->volume.background) / good, 3, 1e-3);
  }
}

TEST(SurfaceToVolume, UnitesBarsThatCross) {
  const auto result =
      surface_to_volume(test::joined(test::box_surface({-100, -1.3, -1.3}, {100, 1.3, 1.3}),
                                     test::box_surface({-1.3, -100, -1.3}, {1.3, 100, 1.3})),
                        1);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_TRUE(result->report.overlaps);
  const double volume = 2 * 200 * 2.6 * 2.6 - 2.6 * 2.6 * 2.6;
  EXPECT_NEAR(result->report.volume / volume, 1, 0.2);
}

TEST(SurfaceToVolume, RefusesAbsurdSizesBeforeTakingMemory) {
  const absl::Status fine = surface_to_volume(box(-1, 1), 1e-5).status();
  EXPECT_EQ(fine.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(fine.message(), HasSubstr("the limit is 1e+09"));
  EXPECT_FALSE(surface_to_volume(box(-1e300, 1e300), 1e-300).ok());
}

/// The volume of the level set of what is converted with voxels of 0.05.
double volume_in_twentieths(const TriangleSurface& surface) {
  const auto result = surface_to_volume(surface, 0.05);
  EXPECT_TRUE(result.ok()) << result.status();
  if (!result.ok()) return 0;
  EXPECT_THAT(result->report.warnings(), ::testing::IsEmpty());
  return result->report.volume;
}

TEST(SurfaceToVolume, KeepsCavitiesAndWhatLeadsToThem) {
  const auto outer = test::sphere_surface({}, 1, 64), inner = test::sphere_surface({}, 0.5, 64);
  EXPECT_NEAR(volume_in_twentieths(test::joined(outer, test::inside_out(inner))),
              test::volume_of(outer) - test::volume_of(inner), 0.01);
  const auto cube = box(0, 1), hollow = test::joined(cube, test::inside_out(box(0.25, 0.75)));
  EXPECT_NEAR(volume_in_twentieths(hollow), 0.875, 0.01);
  for (const double neck : {0.06, 0.08, 0.1, 0.13, 0.16}) {
    const test::Blocks bottle = test::bottle(1, 0.1, neck);
    EXPECT_NEAR(volume_in_twentieths(bottle.surface()), bottle.volume(), 0.01) << neck;
  }
}

TEST(SurfaceToVolume, KeepsPlatesApartOrSaysThatItDoesNot) {
  for (const double gap : {0.2, 0.125, 0.1, 0.075, 0.06, 0.04, 0.02}) {
    const auto plates = test::joined(test::box_surface({0, 0, 0}, {1, 1, 1}),
                                     test::box_surface({0, 0, 1 + gap}, {1, 1, 2 + gap}));
    const auto moved = test::placed(plates, 1, {0.013, 0.017, 0.011});
    const auto result = surface_to_volume(moved, 0.05);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_NEAR(result->report.volume, 2, 0.05) << gap;
    VolumeReader reader(result->volume);
    int outside = 0;
    for (int z = 18; z <= 26; ++z) outside += reader.value({10, 10, z}) > 0 ? 1 : 0;
    EXPECT_NE(outside > 0, result->report.hidden_gaps > 0) << gap;
    EXPECT_NE(outside > 0, result->report.warnings().size() > 0) << gap;
    EXPECT_TRUE(outside > 0 || gap < 0.05) << gap;
  }
}

TEST(SurfaceToVolume, TellsOfWallsBetweenVoxelCentres) {
  const auto with_fin =
      test::Blocks{{{{0.01, 1.01}, {0.01, 1.01}, {0.01, 1.01, 1.024}}}, {1, 1}};
  EXPECT_THAT(surface_to_volume(with_fin.surface(), 0.05)->report.warnings(),
              ::testing::IsEmpty());
  const auto plate = test::box_surface({-1.01, 0.01, 0.511}, {-0.01, 1.01, 0.529});
  const auto result = surface_to_volume(test::joined(with_fin.surface(), plate), 0.05);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_GT(result->report.hidden_walls, 300U);
  EXPECT_THAT(result->report.warnings(),
              ::testing::Contains(HasSubstr("pass between voxel centres")));
}

TEST(SurfaceToVolume, TellsOfBodiesAndCavitiesSmallerThanVoxels) {
  const auto cube = box(0, 1),
             speck = test::box_surface({2.01, 0.01, 0.01}, {2.03, 0.03, 0.03});
  const auto bubble =
      test::inside_out(test::box_surface({0.51, 0.51, 0.51}, {0.53, 0.53, 0.53}));
  for (const auto& small : {speck, bubble}) {
    const auto result = surface_to_volume(test::joined(cube, small), 0.05);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->report.lost_bodies, 1U);
    ASSERT_FALSE(result->report.warnings().empty());
    EXPECT_THAT(result->report.warnings()[0], HasSubstr("1 body or cavity is too small"));
    EXPECT_EQ(surface_to_volume(test::joined(cube, small), 0.008)->report.lost_bodies, 0U);
  }
}

TEST(SurfaceToVolume, UnitesSolidsThatOverlap) {
  EXPECT_NEAR(volume_in_twentieths(test::joined(box(0, 1), box(0.5, 1.5))), 2 - 0.125, 0.02);
  EXPECT_NEAR(
      volume_in_twentieths(test::joined(box(0, 1), test::box_surface({1, 0, 0}, {2, 1, 1}))), 2,
      0.02);
  EXPECT_NEAR(volume_in_twentieths(
                  test::joined(box(0, 1), test::box_surface({1, 0.2, 0.3}, {2, 0.7, 0.7}))),
              1.2, 0.02);
}

TEST(SurfaceToVolume, MendsSmallFaultsAndSaysSo) {
  const auto sphere = test::sphere_surface({}, 1, 64);
  const auto pinhole = surface_to_volume(test::without(sphere, 900, 1), 0.05);
  ASSERT_TRUE(pinhole.ok()) << pinhole.status();
  EXPECT_EQ(pinhole->report.kind, ConvertedTo::kMendedSolid);
  EXPECT_THAT(pinhole->report.text(), HasSubstr("closed but for 3 open edges in 1 hole"));
  EXPECT_NEAR(pinhole->report.volume, test::volume_of(sphere), 0.01);
  const auto turned = surface_to_volume(test::inside_out(sphere), 0.05);
  EXPECT_THAT(turned->report.text(), HasSubstr("1 body turned round"));
  EXPECT_NEAR(turned->report.volume, test::volume_of(sphere), 0.01);
}

TEST(SurfaceToVolume, SaysThatASheetHasNoThickness) {
  const auto open = box(0, 1, 10);
  EXPECT_THAT(surface_to_volume(open, 0.1, OpenSurface::kClose).status().message(),
              HasSubstr("a sheet without thickness"));
  const auto thin = test::box_surface({0.01, 0.01, 0.01}, {1.01, 1.01, 0.02});
  const absl::Status status = surface_to_volume(thin, 0.1).status();
  EXPECT_THAT(status.message(), HasSubstr("use at most 0.00392"));
  EXPECT_TRUE(surface_to_volume(thin, 0.00392).ok());
}

TEST(SurfaceToVolume, IsTheSameAtAnyPlaceAndOfAnySize) {
  const auto solid = test::bottle(20, 3, 4).surface();
  const auto here = surface_to_volume(solid, 1);
  ASSERT_TRUE(here.ok()) << here.status();
  for (const double size : {1e-12, 1e-9, 1e-5, 1e-3, 1e6, 1e9, 1e27}) {
    const auto result = surface_to_volume(test::placed(solid, size, {}), size);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->volume.bricks, here->volume.bricks) << size;
    EXPECT_NEAR(result->report.volume / (size * size * size), here->report.volume, 1e-6)
        << size;
    EXPECT_EQ(result->volume.transform.voxel_size, size);
    for (std::size_t i = 0; i < here->volume.values.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(result->volume.values[i]) / size, here->volume.values[i],
                  1e-5);
    }
  }
  for (const double far : {1e4, 3e5, 5e6, 1e9, 1e12}) {
    const auto result = surface_to_volume(test::placed(solid, 1, {far, -far, far / 10}), 1);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_NEAR(result->report.volume, here->report.volume, 1e-3) << far;
    EXPECT_EQ(result->volume.transform.translation[0], far);
  }
}

TEST(SurfaceToVdb, KeepsTransformsThatOpenVdbDoesNotMake) {
  const test::TestDirectory directory;
  const std::string path = directory.file("small.vdb");
  const auto ball = test::placed(test::sphere_surface({}, 10, 32), 1e-11, {1e-4, 0, 0});
  const auto report = surface_to_vdb(ball, 1e-11, path);
  ASSERT_TRUE(report.ok()) << report.status();
  const auto direct = surface_to_volume(ball, 1e-11);
  const auto loaded = load_volume(path, "surface");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->values, direct->volume.values);
  EXPECT_EQ(loaded->transform, direct->volume.transform);
  EXPECT_EQ(loaded->transform.voxel_size, 1e-11);
  const std::string again = directory.file("again.vdb");
  ASSERT_TRUE(write_volume(*loaded, again).ok());
  EXPECT_EQ(load_volume(again, "surface")->transform, loaded->transform);
}

TEST(SurfaceToVolume, IsRightOrSaysThatItIsNot) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    EXPECT_EQ(test::trial_of_surface(seed).silent, "");
  }
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
