#include "core/base/mask_column.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(MaskColumn, HasWhatWasAdded) {
  BrickMask some, others;
  some.set(1, 2, 3);
  others.set(7, 7, 7);
  const std::array<BrickMask, 6> masks{BrickMask{}, some, BrickMask::all(),
                                       others,      some, BrickMask{}};
  MaskColumn column(masks);
  ASSERT_EQ(column.size(), masks.size());
  for (std::size_t i = 0; i < masks.size(); ++i) EXPECT_EQ(column[i], masks[i]);
  column.push_back(others);
  EXPECT_EQ(column[6], others);
  EXPECT_TRUE(MaskColumn().empty());
  EXPECT_FALSE(column.empty());
}

TEST(MaskColumn, TakesFourBytesForAFullOrAnEmptyMask) {
  std::vector<BrickMask> masks(1000, BrickMask::all());
  masks.resize(2000);
  const MaskColumn column(masks);
  EXPECT_LT(column.bytes(), 2000 * 4 + 1000);
  EXPECT_EQ(MaskColumn::full(10)[9], BrickMask::all());
}

}  // namespace
}  // namespace tet
