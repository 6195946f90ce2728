#include "core/field/cell_signs.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/volume/volume_builder.h"
#include "core/volume/volume_reader.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

TEST(CellSigns, FindEveryCellWhoseTrilinearFieldHasBothSigns) {
  const Volume ball = test::ball(30);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(0, 1);
  for (const double spacing : {1.3, 2.0, 3.7}) {
    PhiField field;
    field.volume = &ball;
    field.spacing_voxels = spacing;
    PhiSampler sampler(field);
    int mixed = 0;
    for (int i = 0; i < 36; ++i) {
      const BrickCoord brick{i / 6 - 3, i % 6 - 3, 0};
      const BrickMask cells = cells_with_both_signs(field, brick);
      for_each_bit(~cells, [&](int x, int y, int z) {
        bool inside = false, outside = false;
        for (int sample = 0; sample < 20; ++sample) {
          const float phi =
              sampler.at(8.0 * brick.x + x + within(random), 8.0 * brick.y + y + within(random),
                         8.0 * brick.z + z + within(random));
          (phi < 0 ? inside : outside) = true;
        }
        EXPECT_FALSE(inside && outside);
      });
      mixed += static_cast<int>(cells.count());
    }
    EXPECT_GT(mixed, 300);
    EXPECT_LT(mixed, 36 * 512 / 4) << "only those near the surface";
  }
}

/// The cells as they are defined: voxel by voxel.
BrickMask cells_by_voxels(const PhiField& field, BrickCoord brick) {
  VolumeReader reader(*field.volume);
  const double s = field.spacing_voxels;
  const auto begin = [&](std::int32_t b, int c) { return s * (8.0 * b + c); };
  BrickMask mixed;
  for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
    const auto first = [&](std::int32_t b, int c) {
      return static_cast<std::int32_t>(std::floor(begin(b, c) - 1)) + 1;
    };
    const auto last = [&](std::int32_t b, int c) {
      return static_cast<std::int32_t>(std::ceil(begin(b, c) + s + 1)) - 1;
    };
    bool inside = false, outside = false;
    for (std::int32_t i = first(brick.x, x); i <= last(brick.x, x); ++i) {
      for (std::int32_t j = first(brick.y, y); j <= last(brick.y, y); ++j) {
        for (std::int32_t k = first(brick.z, z); k <= last(brick.z, z); ++k) {
          (field.phi(reader.value({i, j, k})) < 0 ? inside : outside) = true;
        }
      }
    }
    if (inside && outside) mixed.set(x, y, z);
  });
  return mixed;
}

TEST(CellSigns, AreThoseOfTheVoxelsAcrossRegionsThatAreStoredAndThatAreNot) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 3);
  builder.add_constant_cube({-128, 0, 0}, 128, -3);
  std::vector<float> values(kBrickCells, 2);
  for (const BrickCoord brick :
       {BrickCoord{3, 5, 1}, BrickCoord{16, 2, 2}, BrickCoord{-20, 1, 1}}) {
    values[static_cast<std::size_t>(100 + brick.x)] = -1;
    builder.add_brick(brick, std::span<const float, kBrickCells>(values));
  }
  builder.add_constant_brick({4, 5, 1}, -3);
  const Volume volume = std::move(builder).build().value();
  std::size_t mixed = 0;
  for (const double spacing : {16.0, 20.3}) {
    PhiField field;
    field.volume = &volume;
    field.spacing_voxels = spacing;
    for (const BrickCoord brick :
         {BrickCoord{0, 0, 0}, BrickCoord{-1, 0, 0}, BrickCoord{-2, 0, -1}}) {
      const BrickMask cells = cells_with_both_signs(field, brick);
      EXPECT_EQ(cells, cells_by_voxels(field, brick)) << spacing << ", brick " << brick.x;
      mixed += static_cast<std::size_t>(cells.count());
    }
  }
  EXPECT_GT(mixed, 50U);
}

}  // namespace
}  // namespace tet
