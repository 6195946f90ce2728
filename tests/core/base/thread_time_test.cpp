#include "core/base/thread_time.h"

#include <future>
#include <thread>

#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;

void use_processor(std::chrono::nanoseconds time) {
  const auto begin = thread_time();
  while (thread_time() - begin < time) {
  }
}

TEST(ThreadBudget, IsSpentByItsThreadsWork) {
  const ThreadBudget budget(2ms);
  EXPECT_FALSE(ThreadBudget(1h).is_spent());
  use_processor(2ms);
  EXPECT_TRUE(budget.is_spent());
  EXPECT_TRUE(budget.is_spent());
}

TEST(ThreadBudget, IsNotSpentByTheTimeThatPassesNorByOtherThreads) {
  std::promise<const ThreadBudget*> made;
  std::promise<void> end;
  std::jthread waits([&, ended = end.get_future()] {
    const ThreadBudget budget(20ms);
    made.set_value(&budget);
    ended.wait();
  });
  const ThreadBudget* const budget = made.get_future().get();
  use_processor(30ms);  // so much time has passed at least
  EXPECT_FALSE(budget->is_spent());
  end.set_value();
}

}  // namespace
}  // namespace tet
