// Grids as leaves of scenes.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/scene_evaluator.h"
#include "core/volume/to_voxel.h"
#include "core/volume/volume_reader.h"
#include "tests/support/grid_scenes.h"
#include "tests/support/scenes.h"

namespace tet {
namespace {

using test::BallGrid;
using test::fog_of;
using test::grid_of;
using test::leaf;
using test::random_grid;
using test::SceneWriter;
using testing::StartsWith;

Scene alone(std::shared_ptr<const Volume> volume) {
  SceneWriter writer;
  writer.add(leaf(std::move(volume)));
  return writer.scene();
}

/// Somewhere in the cube around `centre`.
WorldPoint near(const WorldPoint& centre, double half_edge, std::mt19937& random) {
  const auto moved = [&](double from) {
    return from + half_edge * (static_cast<double>(random()) / 2147483648.0 - 1);
  };
  return {moved(centre.x), moved(centre.y), moved(centre.z)};
}

void set_point(scene::Points& points, std::size_t i, const WorldPoint& p) {
  points.x[i] = p.x;
  points.y[i] = p.y;
  points.z[i] = p.z;
}

/// Grids, turned, stretched and copied, with primitives in between. The leaves ask only for
/// what random grids know.
Scene random_grid_scene(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  SceneWriter writer;
  scene::Transform turn;
  turn.of = writer.add(leaf(random_grid(seed)));
  turn.axis = {between(0.1, 1), between(-1, 1), between(-1, 1)};
  turn.angle_deg = between(0, 360);
  turn.scale = {between(0.5, 1.5), between(0.5, 1.5), 1};
  turn.translation = {between(-1, 1), 0.3, between(-1, 1)};
  const std::string turned = writer.add(turn);
  const std::string ball =
      writer.add_moved({0.5, 0, 0}, writer.add(leaf(grid_of({.turned = true}))));
  const std::string shell = writer.add(scene::Shell{ball, 0.2});
  const std::string box = writer.add(scene::RoundedBox{{1, 1, 1}, 0.1});
  const std::string rough = writer.add(scene::Offset{turned, 0.1});
  const auto how = static_cast<scene::Combine>(random() % 3);
  writer.add(scene::Combination{how, {box, shell, rough}, seed % 2 == 0 ? 0.05 : 0});
  return writer.scene();
}

TEST(GridLeaf, IsTheGridsTrilinearValue) {
  std::mt19937 random(1);
  for (const BallGrid& ball : {BallGrid{}, BallGrid{.turned = true, .shifted = true}}) {
    const auto volume = grid_of(ball);
    VolumeReader reader(*volume);
    const Scene scene = alone(volume);
    SceneEvaluator evaluator(scene);
    for (int i = 0; i < 2000; ++i) {
      const WorldPoint p = near({}, 1.6, random);
      ASSERT_NEAR(evaluator.at(p), reader.trilinear(to_voxel(volume->transform, p)), 1e-12);
    }
  }
}

TEST(GridLeaf, OfAFogVolumeIsIsoLessDensity) {
  const Scene scene = alone(fog_of({}));
  SceneEvaluator evaluator(scene);
  EXPECT_DOUBLE_EQ(evaluator.at({0, 0, 0}), -0.5);
  EXPECT_DOUBLE_EQ(evaluator.at({3, 0, 0}), 0.5);
  EXPECT_NEAR(evaluator.at({1, 0, 0}), 0, 1e-6);
}

TEST(GridLeaf, IsBackgroundHoweverFarAway) {
  const Scene scene = alone(grid_of({}));
  SceneEvaluator evaluator(scene);
  for (const double far : {1e3, 1e9, 1e15}) {
    EXPECT_EQ(evaluator.at({far, -far, 0}), static_cast<double>(0.3F));
  }
}

TEST(GridLeaf, HasTheSameBitsInColumnsPointByPointAndInFocus) {
  std::mt19937 random(2);
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = random_grid_scene(seed);
    SceneEvaluator focused(scene), whole(scene);
    for (const double half_edge : {1e-3, 0.1, 0.5, 3.0}) {
      const WorldPoint centre = near({}, 2, random);
      focused.focus(centre, half_edge);
      scene::Points points;
      for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
        set_point(points, i, near(centre, half_edge, random));
      }
      const double* phi = focused.evaluate(points, scene::kMaxPoints);
      for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
        ASSERT_EQ(phi[i], whole.at({points.x[i], points.y[i], points.z[i]})) << seed;
      }
    }
  }
}

TEST(GridLeaf, LiesWithinItsBounds) {
  std::mt19937 random(3);
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = random_grid_scene(seed);
    SceneEvaluator evaluator(scene);
    for (const double half_edge : {0.01, 0.1, 0.4, 2.0}) {
      scene::Points middles;
      for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
        set_point(middles, i, near({}, 2, random));
      }
      const scene::PhiBounds bounds = evaluator.bounds(middles, scene::kMaxPoints, half_edge);
      for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
        const WorldPoint middle{middles.x[i], middles.y[i], middles.z[i]};
        for (int k = 0; k < 8; ++k) {
          const double phi = evaluator.at(near(middle, half_edge, random));
          ASSERT_GE(phi, bounds.low.at[i] - 1e-12) << seed << ", half edge " << half_edge;
          ASSERT_LE(phi, bounds.high.at[i] + 1e-12) << seed << ", half edge " << half_edge;
        }
      }
    }
  }
}

TEST(GridLeaf, IsBoundTightlyBeyondItsBand) {
  const Scene scene = alone(grid_of({}));
  SceneEvaluator evaluator(scene);
  for (const auto& [x, half_edge] : {std::pair(3.5, 1.5), {100.0, 40.0}, {1e6, 1e5}}) {
    scene::Points middle;
    set_point(middle, 0, {x, 0, 0});
    const scene::PhiBounds& bounds = evaluator.bounds(middle, 1, half_edge);
    EXPECT_EQ(bounds.low.at[0], static_cast<double>(0.3F));
    EXPECT_EQ(bounds.high.at[0], static_cast<double>(0.3F));
  }
}

TEST(GridLeaf, ReachesAVoxelBeyondWhatIsInsideAtMost) {
  for (const BallGrid& ball : {BallGrid{}, BallGrid{.turned = true, .shifted = true}}) {
    for (const auto& volume : {grid_of(ball), fog_of(ball)}) {
      const auto [min, max] = alone(volume).extent;
      EXPECT_LE(max.x, 1.1);
      EXPECT_GE(max.x, 1);
      EXPECT_LE(min.z, -1);
      EXPECT_GE(min.z, -1.2);
    }
  }
  SceneWriter writer;
  writer.add(scene::Offset{writer.add(leaf(grid_of({}))), 0.2});
  EXPECT_GE(writer.scene().extent.max.y, 1.2);
  EXPECT_LE(writer.scene().extent.max.y, 1.4);
}

std::string refusal(const SceneWriter& writer) {
  return std::string(make_scene(writer.description()).status().message());
}

/// What a scene of one grid says, and one node that is made of it.
template <class Kind>
std::string refusal_of(Kind kind, std::shared_ptr<const Volume> volume) {
  SceneWriter writer;
  kind.of = {writer.add(leaf(std::move(volume)))};
  if constexpr (requires { kind.smoothing; }) kind.of.push_back(writer.add(scene::Sphere{1}));
  writer.add(kind);
  return refusal(writer);
}

TEST(GridLeaf, KnowsNoDistancesBeyondItsBand) {
  const auto ball = grid_of({});
  const auto refuses = StartsWith(
      "nodes[0].grid knows distances from -0.3 to 0.3, and offsets, shells or blends of it "
      "ask");
  EXPECT_THAT(refusal_of(scene::Offset{"", 0.31}, ball), refuses);
  EXPECT_THAT(refusal_of(scene::Offset{"", -0.31}, ball), refuses);
  EXPECT_THAT(refusal_of(scene::Shell{"", 0.62}, ball), refuses);
  scene::Combination blend{scene::Combine::kUnion, {}, 0.25};
  EXPECT_THAT(refusal_of(blend, ball), refuses);
  EXPECT_EQ(refusal_of(scene::Offset{"", 0.29}, ball), "");
  EXPECT_EQ(refusal_of(scene::Shell{"", 0.58}, ball), "");
  blend.smoothing = 0.23;
  EXPECT_EQ(refusal_of(blend, ball), "");
}

TEST(GridLeaf, MeasuresItsBandUnderTransforms) {
  SceneWriter writer;
  scene::Transform twice;
  twice.of = writer.add(leaf(grid_of({})));
  twice.scale = {2, 2, 2};
  const std::string large = writer.add(twice);
  writer.add(scene::Offset{large, 0.5});
  EXPECT_EQ(refusal(writer), "");
  writer.add(scene::Offset{writer.description().nodes.back().name, 0.2});
  EXPECT_THAT(refusal(writer), testing::HasSubstr("ask for 0.35 to 0.35"));
}

TEST(GridLeaf, IsRefusedWithoutASurface) {
  SceneWriter writer;
  scene::GridSolid grid = leaf(grid_of({}));
  grid.iso = -1;
  writer.add(grid);
  EXPECT_EQ(refusal(writer),
            "nodes[0].grid has no surface at iso -1: its values are from -0.3 to 0.3");
}

TEST(GridLeaf, ReachesAsFarAsTheSideThatIsInside) {
  const auto volume = grid_of({});
  const auto within = [&](SceneWriter& writer, const auto& solid, InsideSide inside) {
    scene::GridSolid side = leaf(volume);
    side.inside = inside;
    const std::vector<std::string> both{writer.add(solid), writer.add(side)};
    return writer.add(scene::Combination{scene::Combine::kIntersection, both, 0});
  };
  for (const bool ball_first : {true, false}) {
    SceneWriter writer;
    std::vector<std::string> parts;
    for (const bool is_ball : {ball_first, !ball_first}) {
      parts.push_back(
          is_ball ? within(writer, scene::Sphere{0.5}, InsideSide::kBelow)
                  : within(writer, scene::RoundedBox{{6, 6, 6}, 0}, InsideSide::kAbove));
    }
    writer.add(scene::Combination{scene::Combine::kUnion, parts, 0});
    const Scene scene = writer.scene();
    EXPECT_TRUE(scene.ends());
    EXPECT_NEAR(scene.extent.max.x, 3, 1e-9);
    EXPECT_NEAR(scene.extent.min.z, -3, 1e-9);
  }
}

TEST(GridLeaf, HasNoEndWhereItsBackgroundIsInside) {
  const auto hole = [] {
    Volume volume = *grid_of({});
    for (float& value : volume.values) value = -value;
    for (ValueRange& range : volume.ranges) range = {-range.max, -range.min};
    for (Region& region : volume.regions) {
      for (float& value : region.constant) value = -value;
    }
    volume.background = -volume.background;
    return std::make_shared<const Volume>(std::move(volume));
  }();
  const Scene scene = alone(hole);
  EXPECT_EQ(scene.endless, "nodes[0].grid");
  SceneWriter writer;
  const std::string box = writer.add(scene::RoundedBox{{3, 3, 3}, 0});
  writer.add(
      scene::Combination{scene::Combine::kIntersection, {box, writer.add(leaf(hole))}, 0});
  EXPECT_TRUE(writer.scene().ends());
}

TEST(GridLeaf, IsRefusedUntilItIsLoaded) {
  SceneWriter writer;
  writer.add(leaf(grid_of({})));
  scene::Description description = writer.description();
  description.grids()[0]->volume = nullptr;
  EXPECT_TRUE(check_scene(description).ok());
  EXPECT_EQ(make_scene(description).status().message(), "nodes[0].grid is not loaded");
}

TEST(GridLeaf, MayBeOneOf16Grids) {
  const auto ball = grid_of({});
  SceneWriter writer;
  scene::Combination all{scene::Combine::kUnion, {}, 0};
  for (std::size_t i = 0; i < 2 * Scene::kMaxGrids; ++i) {
    scene::GridSolid grid = leaf(ball);
    grid.file = std::to_string(i / 2) + ".vdb";
    all.of.push_back(writer.add(grid));
  }
  SceneWriter more = writer;
  writer.add(all);
  EXPECT_EQ(refusal(writer), "");
  EXPECT_EQ(writer.scene().grids.size(), 1U) << "the same one again and again";
  all.of.push_back(more.add(leaf(ball)));
  more.add(all);
  EXPECT_EQ(refusal(more), "nodes[32].grid is one grid too many; the limit is 16");
}

TEST(GridLeaf, HasAFiniteIsoValue) {
  SceneWriter writer;
  scene::GridSolid grid = leaf(grid_of({}));
  grid.iso = std::nan("");
  writer.add(grid);
  EXPECT_THAT(refusal(writer), StartsWith("nodes[0].grid.iso nan is not from"));
}

}  // namespace
}  // namespace tet
