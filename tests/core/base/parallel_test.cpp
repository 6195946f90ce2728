#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <latch>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
  TaskPool pool(4);
  std::vector<int> visits(10007);
  pool.run([&] { for_each_index(visits.size(), [&](std::size_t i) { ++visits[i]; }); });
  EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), 10007);
  EXPECT_EQ(*std::min_element(visits.begin(), visits.end()), 1);
}

TEST(Parallel, CoversTheRangeWithRanges) {
  TaskPool pool(3);
  std::atomic<std::size_t> covered{0};
  pool.run([&] {
    for_each_range(1000, 7,
                   [&](std::size_t begin, std::size_t end) { covered += end - begin; });
    for_each_range(0, 7, [&](std::size_t, std::size_t) { covered += 1000000; });
  });
  EXPECT_EQ(covered, 1000U);
}

TEST(TaskPool, FinishesAllThatWasPostedBeforeItGoes) {
  std::atomic<int> done{0};
  {
    TaskPool pool(2);
    for (int i = 0; i < 100; ++i) {
      pool.post([&] { for_each_index(10, [&](std::size_t) { ++done; }); });
    }
  }
  EXPECT_EQ(done, 1000);
}

TEST(TaskPool, RunsAsManyPostedTasksAtOnceAsItHasThreads) {
  TaskPool pool(2);
  std::latch both(2);  // would never open if the two waited for each other
  for (int i = 0; i < 2; ++i) pool.post([&] { both.arrive_and_wait(); });
  both.wait();
}

TEST(OffsetsFromCounts, EndsWithTheTotal) {
  const auto offsets = offsets_from_counts(4, [](std::size_t i) { return i * i; });
  EXPECT_EQ(offsets, (std::vector<std::uint64_t>{0, 0, 1, 5, 14}));
}

}  // namespace
}  // namespace tet
