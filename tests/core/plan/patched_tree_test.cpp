#include "core/plan/brick/patched_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/field/field_difference.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/unchanged_bricks.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

using Plan = std::shared_ptr<const MeshPlan>;

struct Sphere {
  VoxelCoord centre;
  float radius;
};

/// A ball of 30 voxels without some others: dents, cavities, and holes through it.
std::shared_ptr<const Volume> ball_without(const std::vector<Sphere>& cut) {
  return std::make_shared<const Volume>(test::narrow_band_volume(
      VoxelBox{VoxelCoord{-36, -36, -36}, VoxelCoord{36, 36, 36}}, 3, [&](VoxelCoord v) {
        const auto from = [&](VoxelCoord c) {
          return std::hypot(static_cast<float>(v.x - c.x), static_cast<float>(v.y - c.y),
                            static_cast<float>(v.z - c.z));
        };
        float value = from({0, 0, 0}) - 30;
        for (const auto& [centre, radius] : cut) value = std::max(value, radius - from(centre));
        return value;
      }));
}

/// Frames of a ball; in each a sphere is cut out of it, or is no longer.
std::vector<std::shared_ptr<const Volume>> random_frames(std::uint32_t seed, int count) {
  std::mt19937 random(seed);
  const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 61) - 30; };
  std::vector<std::shared_ptr<const Volume>> frames{ball_without({})};
  std::vector<Sphere> cut;
  while (static_cast<int>(frames.size()) < count) {
    if (!cut.empty() && random() % 3 == 0) {
      cut.erase(cut.begin() + static_cast<std::ptrdiff_t>(random() % cut.size()));
    } else {
      const std::int32_t x = coordinate(), y = coordinate(), z = coordinate();
      cut.push_back({{x, y, z}, static_cast<float>(random() % 9) / 2 + 1});
    }
    frames.push_back(ball_without(cut));
  }
  return frames;
}

Plan plan_of(const std::shared_ptr<const Volume>& volume,
             const MeshRequest& request,
             const MeshPlan* earlier = nullptr) {
  auto plan = plan_mesh({.shape = volume, .request = request, .earlier = earlier});
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.ok() ? *std::move(plan) : nullptr;
}

ComparedMesh counted(const Plan& plan) { return as_bricks(*plan)->counted(); }

void expect_same_masks(const MaskColumn& a, const MaskColumn& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i], b[i]) << i;
}

void expect_same_trees(const Octree& a, const Octree& b) {
  EXPECT_EQ(a.follows_surface, b.follows_surface);
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t level = 0; level < a.levels.size(); ++level) {
    SCOPED_TRACE(testing::Message() << "level " << level);
    ASSERT_EQ(a.levels[level].bricks, b.levels[level].bricks);
    expect_same_masks(a.levels[level].leaf, b.levels[level].leaf);
    expect_same_masks(a.levels[level].refined, b.levels[level].refined);
    EXPECT_TRUE(a.levels[level].inside.empty() && b.levels[level].inside.empty());
  }
}

/// Patches the tree of one plan to that of another. False where it may not be patched.
bool patch_between(const Plan& earlier, const Plan& now, const LeafRules& rules) {
  const ComparedMesh before = counted(earlier), after = counted(now);
  const auto difference = FieldDifference::between(before.field, after.field);
  if (difference == nullptr || difference->touched() == nullptr) return false;
  const Survey& survey = after.mesh.survey();
  const InsideTest is_inside = survey.inside_test();
  const OctreeCover cover;
  const OctreeSpace space{after.field, is_inside, cover, rules};
  const FinestCells finest{survey.bricks, survey.finest};
  const EarlierTree tree{before.mesh.tree(), *difference->touched()};
  if (!can_patch(tree, finest, space)) return false;
  expect_same_trees(patch_tree(finest, tree, space, {}), after.mesh.tree());
  return true;
}

TEST(PatchedTree, IsTheTreeThatIsGrownAlone) {
  int patched = 0, frame = 0;
  for (const std::uint32_t seed : test::few_of(std::vector<std::uint32_t>{1, 2, 3}, 1)) {
    MeshRequest request;
    if (seed == 2) request.spacing = 0.8;
    Plan earlier;
    for (const auto& volume : random_frames(seed, 12)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", frame " << frame++);
      Plan now = plan_of(volume, request);
      ASSERT_TRUE(now);
      if (earlier) patched += patch_between(earlier, now, {.max_levels = request.levels});
      earlier = std::move(now);
    }
  }
  EXPECT_GT(patched, test::sanitized_or(4, 20));
}

TEST(PatchedTree, GivesAPlanTheMeshThatItHasAlone) {
  for (const int levels : {1, 2, kMaxLevels}) {
    const MeshRequest request = test::with_levels(levels);
    Plan earlier;
    int frame = 0, patched = 0;
    for (const auto& volume : random_frames(static_cast<std::uint32_t>(levels), 8)) {
      SCOPED_TRACE(testing::Message() << levels << " levels, frame " << frame++);
      Plan now = plan_of(volume, request, earlier.get());
      const Plan alone = plan_of(volume, request);
      ASSERT_TRUE(now && alone);
      expect_same_trees(counted(now).mesh.tree(), counted(alone).mesh.tree());
      test::expect_same_plans(*now, *alone);
      // The largest of one level would need the boxes that a plan has them cover.
      if (earlier && levels > 1) {
        patched += patch_between(earlier, alone, {.max_levels = levels});
      }
      earlier = std::move(now);
    }
    EXPECT_EQ(patched > 0, levels > 1) << levels;
  }
}

TEST(PatchedTree, IsNotAskedForWhereOtherRulesMakeTheTree) {
  const auto frames = random_frames(4, 2);
  const Plan graded = plan_of(frames[0], {}), now = plan_of(frames[1], {});
  const Plan uniform = plan_of(frames[0], test::with_levels(0));
  ASSERT_TRUE(graded && now && uniform);
  EXPECT_FALSE(patch_between(uniform, now, {.max_levels = kMaxLevels}));
  EXPECT_FALSE(patch_between(graded, now, {.max_levels = 0}));
  EXPECT_FALSE(patch_between(graded, now, {.max_levels = kMaxLevels, .layers = 2}));
}

TEST(UnchangedBricks, OwnTheNodesThatTheyOwned) {
  const auto frames = random_frames(5, 6);
  std::size_t unchanged = 0, bricks = 0;
  Plan earlier = plan_of(frames[0], {});
  for (std::size_t frame = 1; frame < frames.size(); ++frame) {
    SCOPED_TRACE(testing::Message() << "frame " << frame);
    const Plan alone = plan_of(frames[frame], {});
    ASSERT_TRUE(earlier && alone);
    // A plan that was made alone knows of nothing at the surface that it is what it was.
    const CountedMesh &before = counted(earlier).mesh, &now = counted(alone).mesh;
    const std::vector<BrickPlaces> places = find_unchanged_bricks(before, now);
    ASSERT_EQ(places.size(), now.tree().levels.size());
    for (std::size_t level = 0; level < places.size(); ++level) {
      const int l = static_cast<int>(level);
      bricks += places[level].size();
      for (std::size_t i = 0; i < places[level].size(); ++i) {
        const std::uint32_t at = places[level][i];
        if (at == kNewBrick) continue;
        ++unchanged;
        EXPECT_EQ(before.tree().levels[level].bricks[at], now.tree().levels[level].bricks[i]);
        EXPECT_EQ(before.nodes(l).corner[at], now.nodes(l).corner[i]);
        EXPECT_EQ(before.nodes(l).used_corners(at), now.nodes(l).used_corners(i));
        EXPECT_EQ(before.nodes(l).centre[at], now.nodes(l).centre[i]);
      }
    }
    earlier = alone;
  }
  EXPECT_GT(unchanged, bricks / 10);
}

}  // namespace
}  // namespace tet
