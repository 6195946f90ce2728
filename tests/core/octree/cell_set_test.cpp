#include "core/octree/cell_set.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace tet {
namespace {

using CellCoords = std::set<std::array<int, 3>>;

CellCoords coords_of(const CellSet& set) {
  CellCoords cells;
  for (std::size_t i = 0; i < set.bricks.size(); ++i) {
    const auto [bx, by, bz] = set.bricks[i];
    for_each_bit(set.cells[i], [&, bx = bx, by = by, bz = bz](int x, int y, int z) {
      cells.insert({bx * kBrickEdge + x, by * kBrickEdge + y, bz * kBrickEdge + z});
    });
  }
  return cells;
}

/// One cell in `one_of` of bricks on both sides of the origin.
CellSet random_cells(std::uint32_t one_of, std::mt19937& random) {
  CellSetBuilder builder;
  for (int b = 0; b < 27; ++b) {
    BrickMask cells;
    for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
      if (random() % one_of == 0) cells.set(x, y, z);
    });
    builder.add({b / 9 - 2, b / 3 % 3 - 1, b % 3}, cells);
  }
  return builder.take();
}

TEST(CellSet, ParentsAreTheCellsTwiceAsLarge) {
  std::mt19937 random(1);
  for (const std::uint32_t one_of : {1U, 2U, 9U, 300U}) {
    const CellSet cells = random_cells(one_of, random);
    CellCoords parents;
    for (const auto& [x, y, z] : coords_of(cells)) parents.insert({x >> 1, y >> 1, z >> 1});
    EXPECT_EQ(coords_of(parents_of(cells, {})), parents) << one_of;
  }
}

TEST(CellSet, ParentsWithNeighboursHoldAllThatShareAnEdgeWithACell) {
  std::mt19937 random(2);
  for (const std::uint32_t one_of : {1U, 2U, 9U, 300U}) {
    const CellSet cells = random_cells(one_of, random);
    CellCoords parents;
    for (const auto& [x, y, z] : coords_of(cells)) {
      for (int n = 0; n < 27; ++n) {
        const int dx = n / 9 - 1, dy = n / 3 % 3 - 1, dz = n % 3 - 1;
        if (std::abs(dx) + std::abs(dy) + std::abs(dz) > 2) continue;
        parents.insert({(x + dx) >> 1, (y + dy) >> 1, (z + dz) >> 1});
      }
    }
    EXPECT_EQ(coords_of(parents_with_neighbours(cells, {})), parents) << one_of;
  }
}

TEST(CellSet, ParentsOfChildrenAreTheCells) {
  std::mt19937 random(3);
  const CellSet cells = random_cells(7, random);
  EXPECT_EQ(coords_of(parents_of(children_of(cells, {}), {})), coords_of(cells));
}

}  // namespace
}  // namespace tet
