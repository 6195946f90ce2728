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

TEST(MaskColumn, AppendsMasksOfAnotherInRuns) {
  std::vector<BrickMask> masks(40);
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (i % 4 == 1) masks[i] = BrickMask::all();
    if (i % 4 > 1) masks[i].set(static_cast<int>(i % 8), static_cast<int>(i / 8), 3);
  }
  BrickMask other;
  other.set(0, 0, 0);
  const MaskColumn known(masks);
  // Runs of constants alone, of one, and of many; in any order, and some twice.
  const std::vector<std::uint32_t> places{0,  1,        2,  3,        4,  5,  kNoBrick, 20, 21,
                                          22, kNoBrick, 10, kNoBrick, 16, 17, 30,       31, 32};
  const std::vector<BrickMask> found{other, BrickMask{}, BrickMask::all()};
  MaskColumn column;
  column.push_back(other);
  column.append(known, places, found);
  ASSERT_EQ(column.size(), places.size() + 1);
  std::size_t next = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(column[i + 1], places[i] == kNoBrick ? found[next++] : masks[places[i]]) << i;
  }
  column.append_run(known, 7, 0);
  EXPECT_EQ(column.size(), places.size() + 1);
  MaskColumn copy;
  copy.append_run(column, 0, column.size());
  for (std::size_t i = 0; i < column.size(); ++i) EXPECT_EQ(copy[i], column[i]) << i;
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
