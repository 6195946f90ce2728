#include "core/plan/brick/changed_reach.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/brick_box.h"
#include "core/plan/brick/mesh_difference.h"

namespace tet::changed_reach_test {
namespace {

using Points = std::vector<VoxelCoord>;

BrickMask some_bits(std::mt19937& random, int count) {
  BrickMask mask;
  const auto any = [&] { return static_cast<int>(random() % 8); };
  for (int i = 0; i < count; ++i) mask.set(any(), any(), any());
  return mask;
}

/// Where the bits of a brick's mask lie in its level.
Points points_of(const BrickMask& mask, BrickCoord brick) {
  Points points;
  for_each_bit(mask, [&](int x, int y, int z) {
    points.push_back({8 * brick.x + x, 8 * brick.y + y, 8 * brick.z + z});
  });
  return points;
}

/// Bricks around zero, with few leaves.
OctreeLevel sparse_level(std::mt19937& random) {
  OctreeLevel level;
  for_each_brick({{-2, -2, -2}, {2, 2, 2}}, [&](BrickCoord b) { level.bricks.push_back(b); });
  for (std::size_t i = 0; i < level.bricks.size(); ++i) {
    level.leaf.push_back(some_bits(random, static_cast<int>(random() % 4)));
  }
  level.index = BrickIndex(level.bricks);
  return level;
}

using IsRead = std::function<bool(VoxelCoord leaf, VoxelCoord point)>;

/// The bricks that are to be marked, found leaf by leaf.
std::vector<std::uint32_t> expected(const OctreeLevel& level,
                                    const Points& points,
                                    const IsRead& is_read) {
  std::vector<std::uint32_t> tets(level.bricks.size(), 0);
  for (std::size_t i = 0; i < tets.size(); ++i) {
    for (const VoxelCoord leaf : points_of(level.leaf[i], level.bricks[i])) {
      for (const VoxelCoord point : points) {
        if (is_read(leaf, point)) tets[i] = kNewBrick;
      }
    }
  }
  return tets;
}

std::vector<std::uint32_t> marked(const std::vector<std::vector<ChangedBrick>>& changed,
                                  const OctreeLevel& level) {
  std::vector<std::uint32_t> tets(level.bricks.size(), 0);
  mark_readers(changed, level, tets);
  return tets;
}

/// Whether a node is in the closed cube of a leaf of `step` nodes' distances.
bool holds(VoxelCoord leaf, VoxelCoord node, std::int32_t step) {
  const auto within = [&](std::int32_t l, std::int32_t n) {
    return n >= step * l && n <= step * (l + 1);
  };
  return within(leaf.x, node.x) && within(leaf.y, node.y) && within(leaf.z, node.z);
}

TEST(ChangedReach, HasTheLeavesWithANodeOfAFinerLevelInTheirClosedCube) {
  std::mt19937 random(3);
  for (int turn = 0; turn < 300; ++turn) {
    const OctreeLevel level = sparse_level(random);
    for (const std::size_t finer : {0U, 1U, 2U}) {
      SCOPED_TRACE(finer);
      const auto at = [&] { return static_cast<std::int32_t>(random() % 5) - 2; };
      const BrickCoord brick{at(), at(), at()};
      const BrickMask nodes = some_bits(random, 3);
      std::vector<std::vector<ChangedBrick>> changed(finer + 1);
      changed[0].push_back({brick, {}, nodes, nodes});
      const std::int32_t step = std::int32_t{1} << finer;
      const auto has = [step](VoxelCoord leaf, VoxelCoord node) {
        return holds(leaf, node, step);
      };
      EXPECT_EQ(marked(changed, level), expected(level, points_of(nodes, brick), has));
    }
  }
}

TEST(ChangedReach, HasTheLeavesAroundAChangedCell) {
  std::mt19937 random(4);
  for (int turn = 0; turn < 300; ++turn) {
    const OctreeLevel level = sparse_level(random);
    const auto at = [&] { return static_cast<std::int32_t>(random() % 3) - 1; };
    const BrickCoord brick{at(), at(), at()};
    const BrickMask cell = some_bits(random, 1);
    const auto beside = [](VoxelCoord a, VoxelCoord b) {
      const auto near = [](std::int32_t c, std::int32_t d) { return c - d <= 1 && d - c <= 1; };
      return near(a.x, b.x) && near(a.y, b.y) && near(a.z, b.z);
    };
    EXPECT_EQ(marked({{{brick, cell, {}, {}}}}, level),
              expected(level, points_of(cell, brick), beside));
  }
}

}  // namespace
}  // namespace tet::changed_reach_test
