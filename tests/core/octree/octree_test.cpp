#include "core/octree/octree.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/octree/leaf_map.h"

namespace tet {
namespace {

using test::Everywhere;
using test::expect_balanced;
using test::LeafMap;
using test::leaves_of;
using test::one_cell;

TEST(Octree, BalancesLeavesAcrossFacesAndEdges) {
  const Everywhere all(48);
  std::mt19937 random(5);
  for (int trial = 0; trial < 3; ++trial) {
    CellSetBuilder builder;
    for (int cell = 0; cell < 3; ++cell) {
      const auto at = [&] { return static_cast<int>(random() % 8); };
      const auto brick = [&] { return static_cast<std::int32_t>(random() % 4) - 2; };
      BrickMask mask;
      const int z = at(), y = at(), x = at();  // in an order that every compiler keeps to
      mask.set(x, y, z);
      builder.add({brick(), brick(), brick()}, with_siblings(mask));
    }
    const Octree tree =
        build_octree(builder.take(), all.field, all.inside, {}, {.max_levels = 24});
    EXPECT_GT(tree.levels.size(), 3U);
    expect_balanced(leaves_of(tree));
  }
}

TEST(Octree, KeepsLeavesSmallWhereItIsToldTo) {
  const Everywhere all(40);
  const std::vector<BrickBox> cover{{{-5, -5, -5}, {4, 4, 4}}};
  for (const int max_levels : {1, 2}) {
    const Octree tree = build_octree(one_cell({0, 0, 0}, 3, 3, 3), all.field, all.inside,
                                     {cover, {}}, {.max_levels = max_levels});
    EXPECT_EQ(static_cast<int>(tree.levels.size()), max_levels + 1);
    const LeafMap leaves = leaves_of(tree);
    expect_balanced(leaves);
    // Inside corners -39..39 begin cells; coarser leaves begin on every 2nd or 4th.
    int cells = 0;
    leaves.for_each_cell([&](int, int, int, int level) {
      ++cells;
      EXPECT_LE(level, max_levels);
    });
    EXPECT_GT(cells, 72 * 72 * 72) << "the inside is covered";
  }
}

TEST(Octree, RefinesWholeFamiliesOfSiblings) {
  BrickMask one;
  one.set(3, 4, 5);
  const BrickMask family = with_siblings(one);
  EXPECT_EQ(family.count(), 8U);
  for (int x = 2; x <= 3; ++x) {
    for (int y = 4; y <= 5; ++y) {
      for (int z = 4; z <= 5; ++z) EXPECT_TRUE(family.test(x, y, z));
    }
  }
}

}  // namespace
}  // namespace tet
