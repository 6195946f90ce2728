#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <latch>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/own_threads.h"
#include "tests/support/eventually.h"

namespace tet {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
  TaskPool pool(4);
  std::vector<int> visits(10007);
  pool.run([&] { for_each_index(visits.size(), [&](std::size_t i) { ++visits[i]; }); });
  EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), 10007);
  EXPECT_EQ(*std::min_element(visits.begin(), visits.end()), 1);
}

TEST(Parallel, PoolsOneAfterTheOtherMakeNoMoreThreadsThanOne) {
  const auto work = [](std::size_t i) {
    volatile double value = 0;
    for (int step = 0; step < 500; ++step) value = value + static_cast<double>(i);
  };
  for (int i = 0; i < 1000; ++i) {
    TaskPool pool(2);
    pool.run([&] { for_each_index(64, work); });
  }
  const std::filesystem::directory_iterator threads("/proc/self/task");
  EXPECT_LT(std::distance(begin(threads), end(threads)), 40);
}

TEST(Parallel, LosesATaskThatThrowsAndNothingElse) {
  std::atomic<int> done{0};
  {
    TaskPool pool(2);
    for (int i = 0; i < 8; ++i) {
      pool.post([&, i] {
        if (i % 2 == 0) throw std::runtime_error("what a test throws");
        ++done;
      });
    }
  }  // waits for all
  EXPECT_EQ(done, 4);
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

TEST(Parallel, RunsWorksSideBySide) {
  TaskPool pool(2);
  std::latch both(2);
  int first = 0, second = 0;
  // Would never open if one thread had both.
  const auto work = [&](int& done) {
    both.arrive_and_wait();
    ++done;
  };
  pool.run([&] { run_side_by_side([&] { work(first); }, [&] { work(second); }); });
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 1);
}

std::ptrdiff_t threads_of_this_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

TEST(Parallel, LeavesNoThreadBehind) {
  std::thread([] {}).join();  // a sanitizer starts its own with the first
  const std::ptrdiff_t before = threads_of_this_process();
  {
    const WorkerThreads workers;
    TaskPool pool(3);
    std::latch all(3);
    pool.run([&] { for_each_index(3, [&](std::size_t) { all.arrive_and_wait(); }); });
    EXPECT_GE(threads_of_this_process(), 3);
  }
  // Whoever joins a thread knows of its end a moment before the system has cleared it away.
  EXPECT_TRUE(test::eventually([&] { return threads_of_this_process() <= before; }));
}

TEST(OwnThreads, TakeALoopTogetherAndLoopsWithinItAlone) {
  std::vector<int> visits(1000);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  std::latch both(2);
  run_with_own_threads(2, [&] {
    for_each_index(2, [&](std::size_t half) {
      both.arrive_and_wait();  // would never open if one thread had both
      const auto mine = std::this_thread::get_id();
      for_each_index(500, [&](std::size_t i) {
        EXPECT_EQ(std::this_thread::get_id(), mine);
        ++visits[500 * half + i];
      });
      const std::lock_guard lock(mutex);
      threads.insert(mine);
    });
  });
  EXPECT_EQ(threads.size(), 2U);
  EXPECT_TRUE(threads.contains(std::this_thread::get_id()));
  EXPECT_EQ(visits, std::vector<int>(1000, 1));
}

TEST(OwnThreads, HandOnWhatALoopThrows) {
  const auto loop = [] {
    for_each_index(100, [](std::size_t i) {
      if (i == 77) throw std::runtime_error("77");
    });
  };
  EXPECT_THROW(run_with_own_threads(3, loop), std::runtime_error);
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
  std::latch both(2);  // would never open if the two waited for each other
  TaskPool pool(2);    // goes first, when the last task has left the latch
  for (int i = 0; i < 2; ++i) pool.post([&] { both.arrive_and_wait(); });
  both.wait();
}

TEST(OffsetsFromCounts, EndsWithTheTotal) {
  const auto offsets = offsets_from_counts(4, [](std::size_t i) { return i * i; });
  EXPECT_EQ(offsets, (std::vector<std::uint64_t>{0, 0, 1, 5, 14}));
}

/// The priorities of the threads that run what a thread of the lowest priority posts, all of
/// them at once.
std::set<int> priorities_of_posted(int threads) {
  std::set<int> priorities;
  std::latch all(threads);
  std::mutex mutex;
  {
    TaskPool pool(threads);
    const std::jthread polite([&] {
      ::setpriority(PRIO_PROCESS, 0, 19);
      for (int i = 0; i < threads; ++i) {
        pool.post([&] {
          all.arrive_and_wait();
          const std::lock_guard lock(mutex);
          priorities.insert(::getpriority(PRIO_PROCESS, 0));
        });
      }
    });
  }  // where the pool waits for all of it
  return priorities;
}

// oneTBB makes its threads where work is posted, and they serve everybody from then on. More
// than the tests before have made.
TEST(Parallel, ThreadsOfPoolsHaveNotThePriorityOfWhoeverPosts) {
  keep_priority_of_pools();
  EXPECT_EQ(priorities_of_posted(64), std::set<int>{::getpriority(PRIO_PROCESS, 0)});
}

}  // namespace
}  // namespace tet
