#include "core/mesh/surface_projector.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/solids.h"

namespace tet {
namespace {

/// A volume, a mesh's header over it, and the way between both.
struct Scene {
  Volume volume;
  PhiField field;
  LatticeToWorld to_world;
  MeshHeader header;

  explicit Scene(Volume&& meshed, VoxelCoord origin = {}, double spacing_voxels = 1)
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
    const Scene scene(test::ball(12, transform));
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
    const Scene scene(test::ball(12), {3, -2, 1}, spacing);
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
  Scene scene(test::fog_ball(12.2));
  scene.field.iso = 0.5;
  SurfaceProjector projector = scene.projector();
  const PhiSlope inside = projector.at({11.5, 0, 0});
  EXPECT_LT(inside.phi, 0);
  EXPECT_GT(inside.gradient.x, 0);
}

TEST(SurfaceProjector, FindsNothingFarAwayOrWithoutASlope) {
  const Scene scene(test::ball(12));
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
  const Scene here(Volume{near}), there(std::move(far), {8 * kShift, 0, 0});
  SurfaceProjector at_home = here.projector(), away = there.projector();
  const WorldPoint p{9.3, 7.1, -2.2};
  EXPECT_EQ(at_home.at(p).phi, away.at(p).phi);
  EXPECT_EQ(at_home.at(p).gradient.y, away.at(p).gradient.y);
}

}  // namespace
}  // namespace tet
