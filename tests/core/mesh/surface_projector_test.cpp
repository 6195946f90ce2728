#include "core/mesh/improve/surface_projector.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/nearly_cubic.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

/// A volume, a mesh's header over it, and the way between both.
struct MeshedVolume {
  Volume volume;
  PhiField field;
  LatticeToWorld to_world;
  MeshHeader header;

  explicit MeshedVolume(Volume&& meshed, VoxelCoord origin = {}, double spacing_voxels = 1)
      : volume(std::move(meshed)) {
    field.volume = &volume;
    field.spacing_voxels = spacing_voxels;
    const VoxelTransform lattice = field.lattice_transform();
    to_world = {lattice.linear, origin, lattice.mirrors()};
    header.spacing = lattice.voxel_size;
  }

  SurfaceProjector projector() const { return {field, to_world, header}; }
};

/// Turned about z, mirrored in x, small.
VoxelTransform turned() {
  VoxelTransform transform;
  transform.voxel_size = 0.25;
  const double c = 0.25 * std::cos(0.6), s = 0.25 * std::sin(0.6);
  transform.linear = {{{-c, -s, 0}, {-s, c, 0}, {0, 0, 0.25}}};
  return transform;
}

TEST(SurfaceProjector, ReadsPhiAndItsSlopeInWorldUnits) {
  for (const VoxelTransform& transform : {VoxelTransform{}, turned()}) {
    const MeshedVolume scene(test::ball(12, transform));
    SurfaceProjector projector = scene.projector();
    // About the ball's centre, (0.31, -0.17, 0.43) voxels from the origin.
    const WorldPoint centre = transform.to_world({0.31, -0.17, 0.43});
    const Vector out{2.0 / 7, -6.0 / 7, 3.0 / 7};
    const double r = 12.4 * transform.voxel_size;
    const PhiSlope slope =
        projector.at({centre.x + r * out.x, centre.y + r * out.y, centre.z + r * out.z});
    EXPECT_NEAR(slope.phi, 0.4 * transform.voxel_size, 0.03 * transform.voxel_size);
    EXPECT_NEAR(dot(slope.gradient, out), 1, 0.05);
    EXPECT_NEAR(dot(slope.gradient, slope.gradient), 1, 0.05);
  }
}

TEST(SurfaceProjector, FindsTheSurfaceAlongTheSlope) {
  for (const double spacing : {1.0, 0.6, 2.5}) {
    const MeshedVolume scene(test::ball(12), {3, -2, 1}, spacing);
    SurfaceProjector projector = scene.projector();
    const WorldPoint near{12.2 - 3 * spacing, 2 * spacing, -spacing};
    const PhiSlope slope = projector.at(near);
    EXPECT_FALSE(projector.is_on_surface(slope));
    const auto place = projector.project(near, slope.gradient);
    ASSERT_TRUE(place.has_value());
    EXPECT_LT(std::abs(projector.at(*place).phi), 2e-4 * spacing);
    EXPECT_TRUE(projector.is_on_surface(projector.at(*place)));
    EXPECT_EQ(projector.rounded(*place), *place);
  }
}

TEST(SurfaceProjector, KnowsThatDensityFallsOutwards) {
  MeshedVolume scene(test::fog_ball(12.2));
  scene.field.iso = 0.5;
  SurfaceProjector projector = scene.projector();
  const PhiSlope inside = projector.at({11.5, 0, 0});
  EXPECT_LT(inside.phi, 0);
  EXPECT_GT(inside.gradient.x, 0);
}

TEST(SurfaceProjector, FindsNothingFarAwayOrWithoutASlope) {
  const MeshedVolume scene(test::ball(12));
  SurfaceProjector projector = scene.projector();
  EXPECT_FALSE(projector.project({10.5, 0, 0}, {1, 0, 0}).has_value());
  EXPECT_FALSE(projector.project({12.2, 0, 0}, {0, 0, 0}).has_value());
  EXPECT_FALSE(projector.project({40, 0, 0}, {1, 0, 0}).has_value());
}

TEST(SurfaceProjector, SeesTheSameFarOutInIndexSpace) {
  const Volume near = test::ball(12);
  Volume far = near;
  constexpr std::int32_t kShift = 1 << 25;  // bricks
  for (BrickCoord& brick : far.bricks) brick.x += kShift;
  for (Region& region : far.regions) region.min.x += kShift;
  const MeshedVolume here(Volume{near}), there(std::move(far), {8 * kShift, 0, 0});
  SurfaceProjector at_home = here.projector(), away = there.projector();
  const WorldPoint p{9.3, 7.1, -2.2};
  EXPECT_EQ(at_home.at(p).phi, away.at(p).phi);
  EXPECT_EQ(at_home.at(p).gradient.y, away.at(p).gradient.y);
}

TEST(SurfaceProjector, SeesTheVoxelsFarOutInAGridThatIsNearlyCubic) {
  const VoxelCoord at = test::kFarVoxel;
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(0.25 * (v.x - at.x) - 0.5 * (v.y - at.y) + (v.z - at.z));
  };
  const MeshedVolume scene(
      test::dense_volume({{at.x - 8, at.y - 8, at.z - 8}, {at.x + 8, at.y + 8, at.z + 8}}, 0,
                         value, test::nearly_cubic()));
  SurfaceProjector projector = scene.projector();
  // Stored positions are relative to voxel 0.
  VoxelTransform stored = scene.volume.transform;
  stored.translation = {};
  const WorldPoint p = stored.to_world({at.x + 1.25, at.y - 2.0, at.z + 0.5});
  const auto [phi, slope] = projector.at(p);
  EXPECT_NEAR(phi, 0.25 * 1.25 + 0.5 * 2 + 0.5, 1e-5);
  const WorldPoint beside{p.x + 0.01, p.y + 0.02, p.z - 0.03};
  EXPECT_NEAR(projector.at(beside).phi - phi, 0.01 * slope.x + 0.02 * slope.y - 0.03 * slope.z,
              1e-6);
}

// The middle of what is meshed, in units of a scene, may be beyond what 32 bits number.
TEST(SurfaceProjector, SeesASceneInUnitsThatAreSmallBesideIt) {
  constexpr double kUnit = 1e9;
  test::SceneWriter writer;
  writer.add_moved({1000 * kUnit, 0, 0}, writer.add(scene::Sphere{10 * kUnit}));
  const tet::Scene ball = writer.scene();
  PhiField field;
  field.scene = &ball;
  field.spacing_voxels = kUnit;
  MeshHeader header;
  header.spacing = kUnit;
  const VoxelTransform lattice = field.lattice_transform();
  SurfaceProjector projector(field, {lattice.linear, {1000, 0, 0}, false}, header);
  EXPECT_NEAR(projector.at({9 * kUnit, 0, 0}).phi, -kUnit, 1e-6 * kUnit);
  const auto place = projector.project({9.8 * kUnit, 0, 0}, {1, 0, 0});
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->x, 10 * kUnit, 1e-3 * kUnit);
}

TEST(SurfaceProjector, SeesTheSameFromAnOriginBeyondIndexSpace) {
  constexpr double kSpacing = 200;
  const MeshedVolume here(test::ball(12), {}, kSpacing);
  MeshedVolume there(test::ball(12), {1 << 29, 0, 0}, kSpacing);
  there.header.coordinate_type = CoordinateType::kFloat64;
  SurfaceProjector at_home = here.projector(), away = there.projector();
  const double far = std::ldexp(kSpacing, 29);
  EXPECT_EQ(away.at({9.25 - far, 7, -2}).phi, at_home.at({9.25, 7, -2}).phi);
}

}  // namespace
}  // namespace tet
