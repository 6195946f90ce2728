#include "core/scene/scene_evaluator.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace tet {
namespace {

using test::random_scene;

constexpr std::uint32_t kSeeds = 60;

Scene scene_of_seed(std::uint32_t seed) {
  absl::StatusOr<Scene> scene = make_scene(random_scene(seed));
  EXPECT_TRUE(scene.ok()) << seed << ": " << scene.status();
  return *std::move(scene);
}

/// Points about `centre`, not farther than `reach`.
scene::Points points_around(const WorldPoint& centre, double reach, std::mt19937& random) {
  const double half_edge = reach / std::sqrt(3.0);
  const auto moved = [&](double from) {
    return from + half_edge * (static_cast<double>(random()) / 2147483648.0 - 1);
  };
  scene::Points points;
  for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
    points.x[i] = moved(centre.x);
    points.y[i] = moved(centre.y);
    points.z[i] = moved(centre.z);
  }
  return points;
}

WorldPoint point(const scene::Points& points, std::size_t i) {
  return {points.x[i], points.y[i], points.z[i]};
}

double distance(const WorldPoint& a, const WorldPoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(SceneEvaluator, FindsTheSameBitsInColumnsOfAnyLengthAndPointByPoint) {
  std::mt19937 random(1);
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Scene scene = scene_of_seed(seed);
    SceneEvaluator columns(scene), single(scene);
    const scene::Points points = points_around({}, 4, random);
    for (const std::size_t count : {scene::kMaxPoints, std::size_t{13}}) {
      const double* phi = columns.evaluate(points, count);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(phi[i], single.at(point(points, i))) << "seed " << seed << ", point " << i;
      }
    }
  }
}

TEST(SceneEvaluator, LosesNoBitByItsFocus) {
  std::mt19937 random(2);
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Scene scene = scene_of_seed(seed);
    SceneEvaluator focused(scene), whole(scene);
    for (const double reach : {1e-3, 0.1, 0.5, 2.0}) {
      const WorldPoint centre = point(points_around({}, 3, random), 0);
      focused.focus(centre, reach);
      const scene::Points points = points_around(centre, std::sqrt(3.0) * reach, random);
      const double* phi = focused.evaluate(points, scene::kMaxPoints);
      for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
        ASSERT_EQ(phi[i], whole.at(point(points, i))) << "seed " << seed << ", reach " << reach;
      }
    }
  }
}

TEST(SceneEvaluator, ChangesNoFasterThanPointsMove) {
  std::mt19937 random(3);
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Scene scene = scene_of_seed(seed);
    SceneEvaluator evaluator(scene);
    for (const double reach : {1e-2, 0.3, 2.0}) {
      const WorldPoint centre = point(points_around({}, 3, random), 0);
      const double at_centre = evaluator.at(centre);
      const scene::Points points = points_around(centre, reach, random);
      const double* phi = evaluator.evaluate(points, scene::kMaxPoints);
      for (std::size_t i = 0; i < scene::kMaxPoints; ++i) {
        const double moved = distance(centre, point(points, i));
        ASSERT_LE(std::abs(phi[i] - at_centre), moved * (1 + 1e-9) + 1e-12)
            << "seed " << seed << ", reach " << reach;
      }
    }
  }
}

TEST(SceneEvaluator, FindsNothingInsideBeyondTheExtent) {
  std::mt19937 random(4);
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Scene scene = scene_of_seed(seed);
    SceneEvaluator evaluator(scene);
    const auto& [min, max] = scene.extent;
    for (int i = 0; i < 20; ++i) {
      const scene::Points points = points_around({}, 5, random);
      const double* phi = evaluator.evaluate(points, scene::kMaxPoints);
      for (std::size_t k = 0; k < scene::kMaxPoints; ++k) {
        const auto [x, y, z] = point(points, k);
        if (phi[k] > -1e-12) continue;
        ASSERT_TRUE(x >= min.x && x <= max.x && y >= min.y && y <= max.y && z >= min.z &&
                    z <= max.z)
            << "seed " << seed;
      }
    }
  }
}

/// The leaf that decides a point's value, from the last instruction down.
std::uint32_t leaf_from_above(const Scene& scene, const WorldPoint& p) {
  std::vector<double> value(scene.program.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    Scene part = scene;
    part.program.resize(i + 1);
    const std::uint32_t first = part.program.back().first;
    part.program.erase(part.program.begin(), part.program.begin() + first);
    for (scene::Instruction& op : part.program) op.first -= first;
    value[i] = SceneEvaluator(part).at(p);
  }
  auto at = static_cast<std::uint32_t>(value.size()) - 1;
  while (!is_leaf(scene.program[at].op)) {
    const scene::Instruction& op = scene.program[at];
    --at;
    if (!is_binary(op.op)) continue;
    const std::uint32_t left = scene.program[at].first - 1;
    const bool takes_left =
        op.op == scene::Op::kMin ? value[left] <= value[at] : value[left] >= value[at];
    if (takes_left) at = left;
  }
  return at;
}

TEST(SceneEvaluator, TellsWhichLeafDecidesInAndOutOfFocus) {
  std::mt19937 random(5);
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Scene scene = scene_of_seed(seed);
    SceneEvaluator evaluator(scene);
    const scene::Points points = points_around({}, 3, random);
    for (std::size_t k = 0; k < 12; ++k) {
      const WorldPoint p = point(points, k);
      const std::uint32_t expected = leaf_from_above(scene, p);
      ASSERT_EQ(evaluator.leaf_at(p), expected) << "seed " << seed;
      evaluator.focus({p.x + 0.05, p.y, p.z}, 0.1);
      ASSERT_EQ(evaluator.leaf_at(p), expected) << "in focus, seed " << seed;
    }
  }
}

TEST(MakeScene, SaysWhichInstructionsEachNodeBecame) {
  test::SceneWriter writer;
  const std::string ball = writer.add(scene::Sphere{1});
  scene::Repeat three;
  three.of = writer.add_moved({5, 0, 0}, ball);
  three.count = {3, 1, 1};
  three.step = {3, 0, 0};
  writer.add(three);
  const Scene scene = writer.scene();
  EXPECT_EQ(scene.node_names, (std::vector<std::string>{"0", "1", "2"}));
  std::vector<int> copies(3);
  for (const scene::NodeRun& run : scene.runs) {
    ++copies[run.node];
    EXPECT_TRUE(run.node != 0 || run.end == run.begin + 1);
  }
  EXPECT_EQ(copies, (std::vector<int>{3, 3, 1}));
  EXPECT_EQ(scene.runs.back().end, scene.program.size());
}

TEST(SceneEvaluator, MeasuresDistancesToPrimitivesExactly) {
  const auto phi = [](auto kind, const WorldPoint& p) {
    test::SceneWriter writer;
    writer.add(kind);
    const Scene scene = writer.scene();
    return SceneEvaluator(scene).at(p);
  };
  scene::RoundedBox box;
  box.size = {2, 4, 6};
  EXPECT_DOUBLE_EQ(phi(box, {0, 0, 0}), -1);
  box.rounding = 0.5;
  EXPECT_DOUBLE_EQ(phi(box, {3.5, 5.5, 0}), 4.5) << "3 and 4 beyond the inner faces";
  EXPECT_DOUBLE_EQ(phi(scene::Sphere{2}, {3, 4, 0}), 3);
  EXPECT_DOUBLE_EQ(phi(scene::Cylinder{1, 2}, {4, 0, 5}), 5);
  EXPECT_DOUBLE_EQ(phi(scene::Cylinder{1, 2}, {0.5, 0, 0}), -0.5);
  EXPECT_DOUBLE_EQ(phi(scene::Cone{3, 0, 4}, {0, 0, 5}), 3) << "above the tip";
  EXPECT_DOUBLE_EQ(phi(scene::Cone{3, 0, 4}, {4, 3, -2}), 2) << "beside the bottom's rim";
  EXPECT_DOUBLE_EQ(phi(scene::Cone{2, 2, 4}, {1, 0, 0}), -1) << "a cylinder";
  EXPECT_DOUBLE_EQ(phi(scene::Torus{5, 1}, {8, 0, 4}), 4);
  EXPECT_DOUBLE_EQ(phi(scene::Capsule{1, 4}, {3, 0, 6}), 4);
  scene::HalfSpace above;
  above.normal = {0, 0, 3};
  above.offset = 1;
  EXPECT_DOUBLE_EQ(phi(above, {7, 8, 5}), 4);
}

}  // namespace
}  // namespace tet
