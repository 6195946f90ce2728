#include "core/base/scratch_pool.h"

#include <atomic>
#include <cstddef>

#include <gtest/gtest.h>

#include "core/base/parallel.h"

namespace tet {
namespace {

/// Counts how many of it were made.
struct Counted {
  static inline std::atomic<int> made{0};
  Counted() { ++made; }
  int value = 0;
};

TEST(ScratchPool, MakesNoMoreThanThereAreTasksAtATime) {
  Counted::made = 0;
  ScratchPool<Counted> pool;
  for (int turn = 0; turn < 100; ++turn) {
    const ScratchPool<Counted>::Turn one(pool), other(pool);
    EXPECT_NE(&*one, &*other);
  }
  EXPECT_EQ(Counted::made, 2);
}

TEST(ScratchPool, NeverLendsTheSameTwice) {
  ScratchPool<Counted> pool;
  TaskPool threads(4);
  std::atomic<int> torn{0};
  threads.run([&] {
    for_each_index(
        10'000,
        [&](std::size_t i) {
          const ScratchPool<Counted>::Turn turn(pool);
          turn->value = static_cast<int>(i);
          if (turn->value != static_cast<int>(i)) ++torn;
        },
        1);
  });
  EXPECT_EQ(torn, 0);
}

}  // namespace
}  // namespace tet
