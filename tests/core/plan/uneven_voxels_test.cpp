// Meshes of grids whose voxels are no cubes: where the world has them, and with every promise.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"
#include "core/volume/check_transform.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

constexpr std::array<double, 3> kSemiAxes{9, 7, 5};
constexpr double kVolume = 4.0 / 3 * M_PI * kSemiAxes[0] * kSemiAxes[1] * kSemiAxes[2];

using Columns = std::array<std::array<double, 3>, 3>;

/// Steps of 0.4 x 0.4 x 0.8 that are turned, sheared or mirrored.
const std::vector<std::pair<const char*, Columns>> kVoxels{
    {"upright", {{{0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.8}}}},
    {"oblique", {{{0.32, -0.24, 0}, {0.24, 0.32, 0}, {0, 0, 0.8}}}},
    {"sheared", {{{0.4, 0, 0.2}, {0, 0.4, 0.1}, {0, 0, 0.75}}}},
    {"left-handed", {{{0, 0.4, 0}, {0.4, 0, 0}, {0, 0, 0.8}}}},
    {"one percent", {{{0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.404}}}},
};

/// Voxel (0, 0, 0) is the ellipsoid's middle.
std::shared_ptr<const Volume> ellipsoid_of(const Columns& linear) {
  VoxelTransform transform;
  transform.linear = linear;
  transform.translation = {11, -3, 70};
  transform.voxel_size = voxel_edge(transform);
  VolumeBuilder builder(VolumeKind::kLevelSet, 1, transform);
  std::array<float, kBrickCells> values;
  for (std::int32_t x = -4; x < 4; ++x) {
    for (std::int32_t y = -4; y < 4; ++y) {
      for (std::int32_t z = -2; z < 2 + (linear[2][2] < 0.5 ? 1 : 0); ++z) {
        for (int i = 0; i < kBrickCells; ++i) {
          const int at_x = 8 * x + i / 64, at_y = 8 * y + i / 8 % 8, at_z = 8 * z + i % 8;
          const WorldPoint p =
              transform.to_world({static_cast<double>(at_x), static_cast<double>(at_y),
                                  static_cast<double>(at_z)});
          const double r = std::hypot((p.x - 11) / kSemiAxes[0], (p.y + 3) / kSemiAxes[1],
                                      (p.z - 70) / kSemiAxes[2]);
          values[static_cast<std::size_t>(i)] = static_cast<float>(std::min(1.0, r - 1));
        }
        builder.add_brick({x, y, z}, values);
      }
    }
  }
  return std::make_shared<const Volume>(*std::move(builder).build());
}

MeshResult mesh_of(const std::shared_ptr<const Volume>& volume, const MeshRequest& request) {
  TaskPool pool(2);
  absl::StatusOr<MeshResult> made = mesh_volume(pool, {.shape = volume, .request = request});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : MeshResult{};
}

void expect_promises(const MeshResult& made, Preset preset) {
  const AngleBounds bounds = angle_bounds(preset, made.mesh.header.coordinate_type);
  EXPECT_GT(made.quality.min_dihedral_deg, bounds.min_deg);
  EXPECT_LT(made.quality.max_dihedral_deg, bounds.max_deg);
}

TEST(UnevenVoxels, AreMeshedWithinTheBoundsOfEveryPreset) {
  for (const auto& [name, linear] : kVoxels) {
    SCOPED_TRACE(name);
    const auto volume = ellipsoid_of(linear);
    ASSERT_FALSE(has_cubic_voxels(volume->transform));
    for (const Preset preset : kPresets) {
      MeshRequest request;
      request.preset = preset;
      const MeshResult made = mesh_of(volume, request);
      expect_promises(made, preset);
      EXPECT_DOUBLE_EQ(made.mesh.header.spacing, volume->transform.voxel_size);
    }
    MeshRequest inside;
    EXPECT_NEAR(mesh_of(volume, inside).quality.volume, kVolume, 0.01 * kVolume);
  }
}

TEST(UnevenVoxels, AreMeshedAtAnySpacingAndCutByABox) {
  const auto volume = ellipsoid_of(kVoxels[2].second);
  MeshRequest request;
  request.spacing = 0.7;
  EXPECT_NEAR(mesh_of(volume, request).quality.volume, kVolume, 0.02 * kVolume);
  request.box = WorldBox{{11.21, -20, 50}, {40, 20, 90}};
  const MeshResult half = mesh_of(volume, request);
  expect_promises(half, Preset::kDefault);
  EXPECT_LT(half.quality.volume, 0.55 * kVolume);
  EXPECT_GT(half.quality.volume, 0.35 * kVolume);
}

TEST(UnevenVoxels, AreImprovedOnTheirSurface) {
  MeshRequest request;
  request.improve = true;
  const MeshResult made = mesh_of(ellipsoid_of(kVoxels[1].second), request);
  EXPECT_GT(made.quality.min_dihedral_deg, 18);
  EXPECT_NEAR(made.quality.volume, kVolume, 0.01 * kVolume);
}

TEST(UnevenVoxels, MayHaveTheirInsideAbove) {
  const auto volume = ellipsoid_of(kVoxels[0].second);
  auto turned = std::make_shared<Volume>(*volume);
  for (float& value : turned->values) value = -value;
  for (ValueRange& range : turned->ranges) range = {-range.max, -range.min};
  for (Region& region : turned->regions) {
    for (float& value : region.constant) value = -value;
  }
  turned->background = -volume->background;
  MeshRequest request;
  const MeshResult below = mesh_of(volume, request);
  request.inside = InsideSide::kAbove;
  request.iso = 0;
  EXPECT_EQ(mesh_of(turned, request).quality.volume, below.quality.volume);
}

TEST(UnevenVoxels, AreRefusedWithTheirValuesWhereNothingIsInside) {
  MeshRequest request;
  request.iso = -3;
  TaskPool pool(1);
  const auto made =
      mesh_volume(pool, {.shape = ellipsoid_of(kVoxels[0].second), .request = request});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_NE(made.status().message().find("values are from -1 to 1"), std::string::npos)
      << made.status();
}

// Positions of their meshes are float32 numbers, and shapes of their tets doubles.
TEST(UnevenVoxels, AreRefusedWhereTheyAreTooSmallOrTooLargeForNumbers) {
  const auto is_usable = [](double edge) {
    VoxelTransform transform;
    transform.voxel_size = edge;
    transform.linear = {{{edge, 0, 0}, {0, edge, 0}, {0, 0, 2 * edge}}};
    return check_transform(transform).ok();
  };
  for (const double edge : {1e-27, 1.0, 1e27}) EXPECT_TRUE(is_usable(edge)) << edge;
  for (const double edge : {1e-120, 1e-29, 1e28, 1e120}) EXPECT_FALSE(is_usable(edge)) << edge;
}

}  // namespace
}  // namespace tet
