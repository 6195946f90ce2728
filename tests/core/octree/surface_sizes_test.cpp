#include "core/octree/surface_sizes.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/field/find_bricks.h"
#include "core/field/find_scene_bricks.h"
#include "core/octree/surface_probe.h"
#include "tests/support/counted_looks.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

PhiField field_of(const Scene& scene, double spacing) {
  PhiField field;
  field.scene = &scene;
  field.spacing_voxels = spacing;
  return field;
}

PhiField field_of(const Volume& volume, double spacing = 1) {
  PhiField field;
  field.volume = &volume;
  field.spacing_voxels = spacing;
  return field;
}

template <class Kind>
Scene scene_of(Kind kind) {
  test::SceneWriter writer;
  writer.add(kind);
  return writer.scene();
}

TEST(SurfaceProbe, MeasuresTheCurvatureOfExactShapes) {
  const Scene ball = scene_of(scene::Sphere{2}), torus = scene_of(scene::Torus{3, 0.5});
  const Scene pipe = scene_of(scene::Cylinder{1.5, 8});
  constexpr double kSpacing = 0.05;
  SurfaceProbe of_ball(field_of(ball, kSpacing)), of_torus(field_of(torus, kSpacing)),
      of_pipe(field_of(pipe, kSpacing));
  const auto at = [](double x, double y, double z) {
    return VoxelPoint{x / kSpacing, y / kSpacing, z / kSpacing};
  };
  of_ball.visit(at(1.2, 1.63, 0));
  EXPECT_NEAR(of_ball.curvature() / kSpacing, 1 / 2.0, 0.01);
  of_torus.visit(at(3.48, 0, 0.03));  // the outer rim: 1 / 0.5 around the tube
  EXPECT_NEAR(of_torus.curvature() / kSpacing, 2, 0.05);
  of_pipe.visit(at(0, 1.52, 1));
  EXPECT_NEAR(of_pipe.curvature() / kSpacing, 1 / 1.5, 0.01);
  of_pipe.visit(at(0.3, 0.2, 4.02));  // its flat end
  EXPECT_NEAR(of_pipe.curvature() / kSpacing, 0, 0.01);
}

TEST(SurfaceProbe, MeasuresTheCurvatureOfAStoredLevelSet) {
  const Volume ball = test::ball(25);
  for (const double spacing : {1.0, 0.5}) {
    SurfaceProbe probe(field_of(ball, spacing));
    for (const VoxelPoint& p :
         {VoxelPoint{25, 0, 0}, VoxelPoint{15, 20, 0}, VoxelPoint{14, -15, 14.3}}) {
      probe.visit({p.x / spacing, p.y / spacing, p.z / spacing});
      EXPECT_NEAR(probe.curvature() / spacing, 1 / 25.0, 0.01);
    }
  }
}

TEST(SurfaceProbe, MeasuresHowThickWallsAre) {
  const Volume plate = test::plate({.thickness = 6, .radius = 20});
  SurfaceProbe probe(field_of(plate));
  const VoxelPoint normal{0.36, 0.48, 0.8};
  probe.visit({3.2 * normal.x, 3.2 * normal.y, 3.2 * normal.z});
  EXPECT_NEAR(probe.thickness(100), 6, 0.5);
  EXPECT_EQ(probe.thickness(4), 4);
  const Scene shell = scene_of(scene::RoundedBox{{10, 10, 0.3}, 0});
  SurfaceProbe of_box(field_of(shell, 0.02));
  of_box.visit({20, 33, 7.6});
  EXPECT_NEAR(of_box.thickness(1000), 15, 0.5);
}

TEST(SurfaceProbe, TakesAFieldWithoutASlopeForFlat) {
  const Volume ball = test::ball(25);
  SurfaceProbe probe(field_of(ball));
  probe.visit({0, 0, 0});
  EXPECT_EQ(probe.curvature(), 0);
  EXPECT_EQ(probe.thickness(50), 50);
}

/// A cavity in what is inside wherever nothing is stored.
Volume cavity() {
  Volume volume = test::ball(25);
  volume.background = -volume.background;
  for (float& value : volume.values) value = -value;
  for (ValueRange& range : volume.ranges) range = {-range.max, -range.min};
  for (Region& region : volume.regions) {
    for (float& value : region.constant) value = -value;
  }
  for (ConstantCube& cube : volume.cubes) cube.value = -cube.value;
  return volume;
}

TEST(SurfaceProbe, WalksNoFurtherThanValuesAreStored) {
  const Volume volume = cavity();
  const PhiField field = field_of(volume);
  const auto extent = stored_extent_amid_inside(field);
  ASSERT_TRUE(extent);
  EXPECT_FALSE(stored_extent_amid_inside(field_of(test::ball(25))));
  SurfaceProbe probe(field, extent);
  test::CountedLooks counted{.most = 10};
  probe.stop_when(counted.cancellation);
  probe.visit({15, 20, 0});
  constexpr double kMost = 1e9;
  EXPECT_EQ(probe.thickness(kMost), kMost);
  EXPECT_EQ(counted.looks, 0U);  // there is one after each thousand steps
}

TEST(SurfaceProbe, LooksAtItsCancellationOnALongWay) {
  const Volume volume = cavity();
  SurfaceProbe probe(field_of(volume));  // it is not told where values end
  test::CountedLooks counted{.most = 3};
  probe.stop_when(counted.cancellation);
  probe.visit({15, 20, 0});
  EXPECT_EQ(probe.thickness(1e9), 1e9);
  EXPECT_EQ(counted.looks, 4U);
}

TEST(SurfaceSizes, AskNothingOfCellsThatDoNotFitIntoTheDomain) {
  const Volume volume = cavity();
  const PhiField field = field_of(volume);
  const auto found = find_bricks(field);
  ASSERT_TRUE(found.ok()) << found.status();
  Sizing sizing;
  sizing.chord_error = 0.5;  // of 25: leaves of 10
  sizing.leaves_across = Sizing::kMaxLeavesAcross;
  const BrickBox domain{{-5, -5, -5}, {4, 4, 4}};
  constexpr int kLevels = 12;
  const auto cells = [&](const std::optional<BrickBox>& within) {
    return surface_cells_to_refine(sizing, field, found->near_surface, within, kLevels,
                                   Cancellation());
  };
  const auto all = cells({}), fitting = cells(domain);
  ASSERT_EQ(all.size(), fitting.size());
  EXPECT_FALSE(fitting[4].bricks.empty());
  for (std::size_t level = 0; level <= 6; ++level) {  // 64 of the domain's 80 cells
    EXPECT_EQ(all[level].bricks, fitting[level].bricks);
    EXPECT_EQ(all[level].cells, fitting[level].cells);
  }
}

/// Cells of each level that are no leaves.
std::vector<std::size_t> refined_counts(const Sizing& sizing, const PhiField& field) {
  const auto found =
      field.scene != nullptr
          ? find_scene_bricks(field, std::nullopt, kMaxSurfaceBricks, Cancellation())
          : find_bricks(field);
  std::vector<std::size_t> counts;
  for (const CellSet& cells : surface_cells_to_refine(sizing, field, found->near_surface,
                                                      std::nullopt, 5, Cancellation())) {
    std::size_t count = 0;
    for (const BrickMask& mask : cells.cells) count += mask.count();
    counts.push_back(count);
  }
  return counts;
}

TEST(SurfaceSizes, AllowABallChordsOfItsRadius) {
  const Scene ball = scene_of(scene::Sphere{1});
  Sizing sizing;
  // A chord of 0.3 departs from the ball by 0.01125: between 8 and 16 spacings of 0.025.
  sizing.chord_error = 0.01125;
  const auto counts = refined_counts(sizing, field_of(ball, 0.025));
  for (const std::size_t level : {1U, 2U, 3U, 5U}) EXPECT_EQ(counts[level], 0U) << level;
  EXPECT_GT(counts[4], 50U);
}

TEST(SurfaceSizes, AreSmallWhereOnlyAPartIsSharplyBent) {
  const Scene torus = scene_of(scene::Torus{1, 0.2});
  Sizing sizing;
  sizing.chord_error = 0.01;  // of 0.2: 0.126; six spacings and a bit
  const auto counts = refined_counts(sizing, field_of(torus, 0.02));
  EXPECT_GT(counts[3], 50U);
  EXPECT_EQ(counts[1] + counts[5], 0U);
}

TEST(SurfaceSizes, AllowWallsSoManyLeaves) {
  const Volume plate = test::plate({.thickness = 12, .radius = 30});
  Sizing sizing;
  sizing.leaves_across = 3;  // leaves of 4 voxels
  const auto counts = refined_counts(sizing, field_of(plate));
  EXPECT_GT(counts[3] + counts[2], 50U);
  EXPECT_LT(counts[4] + counts[5], counts[3]);  // the rim, seen from its side
}

}  // namespace
}  // namespace tet
