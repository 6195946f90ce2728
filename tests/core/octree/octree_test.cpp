#include "core/octree/octree.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "core/grid/volume_builder.h"

namespace tet {
namespace {

/// A field whose every lattice corner is inside: only the finest cells shape the tree.
struct Everywhere {
  Volume volume = *VolumeBuilder(VolumeKind::kLevelSet, 1.0F).build();
  PhiField field;
  InsideTest inside;

  explicit Everywhere(std::int64_t half) {
    field.volume = &volume;
    inside = [half](PhiSampler&, std::int64_t x, std::int64_t y, std::int64_t z) {
      return std::abs(x) < half && std::abs(y) < half && std::abs(z) < half;
    };
  }
};

CellSet one_cell(BrickCoord brick, int x, int y, int z) {
  BrickMask mask;
  mask.set(x, y, z);
  return {{brick}, {with_siblings(mask)}};
}

/// Every leaf by the finest cells it covers.
using LeafMap = std::map<std::tuple<int, int, int>, int>;  // finest cell -> level

LeafMap leaves_of(const Octree& tree) {
  LeafMap leaves;
  for (int level = 0; level < static_cast<int>(tree.levels.size()); ++level) {
    const OctreeLevel& l = tree.levels[static_cast<std::size_t>(level)];
    for (std::size_t i = 0; i < l.bricks.size(); ++i) {
      for_each_bit(l.leaf[i], [&](int x, int y, int z) {
        const int edge = 1 << level;
        const std::array<int, 3> at{(8 * l.bricks[i].x + x) * edge,
                                    (8 * l.bricks[i].y + y) * edge,
                                    (8 * l.bricks[i].z + z) * edge};
        for (int dx = 0; dx < edge; ++dx) {
          for (int dy = 0; dy < edge; ++dy) {
            for (int dz = 0; dz < edge; ++dz) {
              const bool is_new =
                  leaves.emplace(std::tuple(at[0] + dx, at[1] + dy, at[2] + dz), level).second;
              EXPECT_TRUE(is_new) << "two leaves cover one cell";
            }
          }
        }
      });
    }
  }
  return leaves;
}

void expect_balanced(const LeafMap& leaves) {
  for (const auto& [cell, level] : leaves) {
    const auto [x, y, z] = cell;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          if (dx != 0 && dy != 0 && dz != 0) continue;  // corners may differ by more
          const auto other = leaves.find(std::tuple(x + dx, y + dy, z + dz));
          if (other == leaves.end()) continue;
          ASSERT_LE(std::abs(other->second - level), 1) << x << ' ' << y << ' ' << z;
        }
      }
    }
  }
}

TEST(Octree, BalancesLeavesAcrossFacesAndEdges) {
  const Everywhere all(48);
  std::mt19937 random(5);
  for (int trial = 0; trial < 3; ++trial) {
    CellSetBuilder builder;
    for (int cell = 0; cell < 3; ++cell) {
      const auto at = [&] { return static_cast<int>(random() % 8); };
      const auto brick = [&] { return static_cast<std::int32_t>(random() % 4) - 2; };
      BrickMask mask;
      mask.set(at(), at(), at());
      builder.add({brick(), brick(), brick()}, with_siblings(mask));
    }
    const Octree tree = build_octree(builder.take(), all.field, all.inside, {}, 24);
    EXPECT_GT(tree.levels.size(), 3U);
    expect_balanced(leaves_of(tree));
  }
}

TEST(Octree, KeepsLeavesSmallWhereItIsToldTo) {
  const Everywhere all(40);
  const std::vector<BrickBox> cover{
      {{-5, -5, -5}, {4, 4, 4}}
  };
  for (const int max_levels : {1, 2}) {
    const Octree tree = build_octree(one_cell({0, 0, 0}, 3, 3, 3), all.field, all.inside,
                                     {cover, {}}, max_levels);
    EXPECT_EQ(static_cast<int>(tree.levels.size()), max_levels + 1);
    const LeafMap leaves = leaves_of(tree);
    expect_balanced(leaves);
    // Inside corners -39..39 begin cells; coarser leaves begin on every 2nd or 4th.
    for (const auto& [cell, level] : leaves) EXPECT_LE(level, max_levels);
    EXPECT_GT(leaves.size(), 72U * 72 * 72) << "the inside is covered";
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
