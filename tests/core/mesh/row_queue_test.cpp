#include "core/mesh/stable/row_queue.h"

#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tet::row_queue_test {
namespace {

TEST(RowQueue, HandsOutInPiecesWhatNoRunKeeps) {
  std::mt19937 random(13);
  for (int turn = 0; turn < 200; ++turn) {
    std::vector<KeptRun> kept;
    std::vector<std::uint64_t> expected, rows;
    std::uint64_t next = 0;
    for (int runs = static_cast<int>(random() % 6); runs > 0; --runs) {
      for (std::uint64_t gap = random() % 4; gap > 0; --gap) expected.push_back(next++);
      kept.push_back({0, next, random() % 5});
      next += kept.back().count;
    }
    for (std::uint64_t gap = random() % 4; gap > 0; --gap) expected.push_back(next++);
    RowQueue queue = RowQueue::beside(kept, next);
    while (rows.size() < expected.size()) {
      const std::uint64_t count = random() % (expected.size() - rows.size() + 1);
      const std::uint64_t before = rows.size();
      ASSERT_TRUE(
          queue.take(count, [&](std::uint64_t row, std::uint64_t at, std::uint64_t taken) {
            ASSERT_EQ(before + at, rows.size());
            for (std::uint64_t i = 0; i < taken; ++i) rows.push_back(row + i);
          }));
      ASSERT_EQ(rows.size(), before + count);
    }
    EXPECT_EQ(rows, expected);
    EXPECT_FALSE(queue.take(1, [](std::uint64_t, std::uint64_t, std::uint64_t) { FAIL(); }));
  }
}

}  // namespace
}  // namespace tet::row_queue_test
