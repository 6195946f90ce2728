#include "core/field/field_difference.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/field/find_bricks.h"
#include "core/field/find_scene_bricks.h"
#include "tests/support/grid_scenes.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

constexpr int kFirstNode = -2, kLastCorner = 10, kLastCentre = 9;

bool same_nodes(const std::array<float, kHaloNodes>& a,
                const std::array<float, kHaloNodes>& b,
                int last) {
  for (int x = kFirstNode; x <= last; ++x) {
    for (int y = kFirstNode; y <= last; ++y) {
      for (int z = kFirstNode; z <= last; ++z) {
        const auto at = static_cast<std::size_t>(halo_index(x, y, z));
        if (a[at] != b[at]) return false;
      }
    }
  }
  return true;
}

struct Counts {
  std::size_t same = 0, bricks = 0;
};

/// Where the samples are said to be the same they are, to the last bit.
Counts expect_honest(const PhiField& earlier,
                     const PhiField& now,
                     const std::vector<BrickCoord>& bricks) {
  Counts counts;
  const auto difference = FieldDifference::between(earlier, now);
  EXPECT_NE(difference, nullptr);
  if (difference == nullptr) return counts;
  FieldDifference::Asker asker(*difference);
  PhiSampler before(earlier), after(now);
  const auto a = std::make_unique<BrickSamples>(), b = std::make_unique<BrickSamples>();
  for (const BrickCoord brick : bricks) {
    ++counts.bricks;
    if (!asker.same_around(brick)) continue;
    ++counts.same;
    before.sample(brick, *a);
    after.sample(brick, *b);
    EXPECT_TRUE(same_nodes(a->corner, b->corner, kLastCorner));
    EXPECT_TRUE(same_nodes(a->centre, b->centre, kLastCentre));
  }
  return counts;
}

PhiField field_of(const Volume& volume, double spacing) {
  PhiField field;
  field.volume = &volume;
  field.spacing_voxels = spacing;
  return field;
}

TEST(FieldDifference, FindsWhichBricksOfAGridReadWhatChanged) {
  const Volume volume = test::ball(24);
  Volume changed = volume;
  const std::size_t brick = changed.bricks.size() / 3;
  changed.values[brick * kBrickCells + 77] += 0.25F;
  for (const double spacing : {1.0, 0.7, 1.3, 9.7}) {
    const PhiField earlier = field_of(volume, spacing), now = field_of(changed, spacing);
    const auto bricks = find_bricks(earlier)->near_surface;
    const Counts counts = expect_honest(earlier, now, bricks);
    EXPECT_LT(counts.same, counts.bricks);
    const std::size_t least = spacing < 2 ? counts.bricks * 8 / 10 : 0;
    EXPECT_GE(counts.same, least) << spacing;
  }
}

TEST(FieldDifference, SeesBricksThatCameWentOrBecameConstant) {
  const Volume one = test::ball(20), other = test::ball(21);
  const PhiField earlier = field_of(one, 1), now = field_of(other, 1);
  auto bricks = find_bricks(earlier)->near_surface;
  const auto more = find_bricks(now)->near_surface;
  bricks.insert(bricks.end(), more.begin(), more.end());
  EXPECT_EQ(expect_honest(earlier, now, bricks).same, 0U);
}

TEST(FieldDifference, FindsNothingChangedInACopy) {
  const Volume volume = test::gyroid_ball(40), copy = volume;
  const PhiField earlier = field_of(volume, 1), now = field_of(copy, 1);
  const Counts counts = expect_honest(earlier, now, find_bricks(earlier)->near_surface);
  EXPECT_EQ(counts.same, counts.bricks);
}

TEST(FieldDifference, TakesCallersAtTheirWordOfWhatWasReplaced) {
  const Volume volume = test::ball(24);
  Volume changed = volume;
  const std::size_t brick = changed.bricks.size() / 3;
  changed.values[brick * kBrickCells + 77] += 0.25F;
  const BrickCoord elsewhere = volume.bricks[0];
  const std::vector<BrickCoord> none, exact{volume.bricks[brick]},
      more{volume.bricks[brick], elsewhere, {1000, -1000, 3}, elsewhere};
  for (const double spacing : {1.0, 0.7, 1.3, 9.7}) {
    const PhiField earlier = field_of(volume, spacing), now = field_of(changed, spacing);
    const auto bricks = find_bricks(earlier)->near_surface;
    const auto compared = FieldDifference::between(earlier, now),
               told_none = FieldDifference::between(earlier, now, &none),
               told = FieldDifference::between(earlier, now, &exact),
               told_more = FieldDifference::between(earlier, now, &more);
    FieldDifference::Asker of_compared(*compared), of_none(*told_none), of_told(*told),
        of_more(*told_more);
    bool misses_elsewhere = false;
    for (const BrickCoord b : bricks) {
      EXPECT_EQ(of_told.same_around(b), of_compared.same_around(b));
      EXPECT_TRUE(of_none.same_around(b));
      if (of_more.same_around(b)) {
        EXPECT_TRUE(of_compared.same_around(b));
      }
      misses_elsewhere |= of_compared.same_around(b) && !of_more.same_around(b);
    }
    EXPECT_TRUE(misses_elsewhere) << spacing;
  }
}

TEST(FieldDifference, ListsNoMoreBricksThanThereIsMemoryFor) {
  const Volume volume = test::ball(9);
  Volume changed = volume;
  changed.values[77] += 0.25F;
  const std::vector<BrickCoord> one{volume.bricks[0]}, far{{1 << 26, 0, -(1 << 26)}};
  for (const double spacing : {1e-3, 1e-9, 1e-300}) {
    const PhiField earlier = field_of(volume, spacing), now = field_of(changed, spacing);
    EXPECT_EQ(FieldDifference::between(earlier, now), nullptr) << spacing;
    EXPECT_EQ(FieldDifference::between(earlier, now, &one), nullptr) << spacing;
  }
  // Few of them are listed wherever they lie: beyond all lattices, too.
  EXPECT_NE(FieldDifference::between(field_of(volume, 0.05), field_of(volume, 0.05), &far),
            nullptr);
}

TEST(FieldDifference, ComparesLatticesWhateverWasReplaced) {
  const Volume volume = test::ball(9);
  const std::vector<BrickCoord> none;
  Volume moved = volume, turned = volume, other_background = volume, other_kind = volume;
  moved.transform.translation[1] = 0.5;
  turned.transform.linear[0][1] = 0.25;
  other_background.background += 1;
  other_kind.kind = VolumeKind::kFogVolume;
  for (const Volume* other : {&moved, &turned, &other_background, &other_kind}) {
    EXPECT_EQ(FieldDifference::between(field_of(volume, 1), field_of(*other, 1), &none),
              nullptr);
  }
  PhiField other_iso = field_of(volume, 1);
  other_iso.iso = 0.5F;
  EXPECT_EQ(FieldDifference::between(field_of(volume, 1), other_iso, &none), nullptr);
  EXPECT_EQ(FieldDifference::between(field_of(volume, 1), field_of(volume, 2), &none), nullptr);
}

TEST(FieldDifference, FindsWhichBricksOfASceneSeeWhatMoved) {
  const auto two_balls = [](double x) {
    test::SceneWriter writer;
    const std::string ball = writer.add(scene::Sphere{1});
    const std::string still = writer.add_moved({-4, 0, 0}, ball);
    const std::string moving = writer.add_moved({x, 0, 0}, ball);
    writer.add(scene::Combination{scene::Combine::kUnion, {still, moving}, 0.2});
    return writer.scene();
  };
  const Scene one = two_balls(0), other = two_balls(0.01);
  PhiField earlier, now;
  earlier.scene = &one;
  now.scene = &other;
  earlier.spacing_voxels = now.spacing_voxels = 0.04;
  const auto bricks =
      find_scene_bricks(earlier, std::nullopt, kMaxSurfaceBricks, Cancellation())->near_surface;
  const Counts counts = expect_honest(earlier, now, bricks);
  EXPECT_GT(counts.same, counts.bricks * 4 / 10);
  EXPECT_LT(counts.same, counts.bricks * 6 / 10);
}

TEST(FieldDifference, TakesGridsInScenesForTheSameOnlyWhereTheyAreOne) {
  const auto bored = [](std::shared_ptr<const Volume> grid, double x) {
    test::SceneWriter writer;
    const std::string scan = writer.add(test::leaf(std::move(grid)));
    const std::string hole = writer.add_moved({x, 0, 0}, writer.add(scene::Sphere{0.3}));
    writer.add(scene::Combination{scene::Combine::kDifference, {scan, hole}, 0});
    return writer.scene();
  };
  const auto grid = test::grid_of({.voxel = 0.05}), copy = test::grid_of({.voxel = 0.05});
  const Scene one = bored(grid, 1), other = bored(grid, 1.02), another = bored(copy, 1);
  PhiField earlier, now, apart;
  earlier.scene = &one;
  now.scene = &other;
  apart.scene = &another;
  earlier.spacing_voxels = now.spacing_voxels = apart.spacing_voxels = 0.04;
  const auto bricks =
      find_scene_bricks(earlier, std::nullopt, kMaxSurfaceBricks, Cancellation())->near_surface;
  const Counts counts = expect_honest(earlier, now, bricks);
  EXPECT_GT(counts.same, counts.bricks / 2);
  EXPECT_LT(counts.same, counts.bricks);
  EXPECT_EQ(expect_honest(earlier, apart, bricks).same, 0U);
}

TEST(FieldDifference, ComparesOnlyWhatLiesOnOneLattice) {
  const Volume volume = test::ball(9);
  Volume moved = volume;
  moved.transform.translation[1] = 0.5;
  EXPECT_EQ(FieldDifference::between(field_of(volume, 1), field_of(volume, 2)), nullptr);
  EXPECT_EQ(FieldDifference::between(field_of(volume, 1), field_of(moved, 1)), nullptr);
  const Scene scene = test::known_scenes()[0].scene;
  PhiField of_scene;
  of_scene.scene = &scene;
  EXPECT_EQ(FieldDifference::between(field_of(volume, 1), of_scene), nullptr);
}

}  // namespace
}  // namespace tet
