#include "core/field/cell_signs.h"

#include <random>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tet
