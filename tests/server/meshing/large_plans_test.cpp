#include "server/meshing/large_plans.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "server/rpc/background.h"
#include "server/rpc/fair_tasks.h"

namespace tet {
namespace {

/// Lets tasks write a word, none before `begin`.
class Order {
 public:
  template <class Queue>
  void post(Queue& queue, const std::string& client, char letter) {
    queue.post(client, [this, letter, begun = begun_] {
      begun.wait();
      const std::lock_guard lock(mutex_);
      word_ += letter;
    });
  }
  void begin() { begin_.set_value(); }
  const std::string& word() const { return word_; }

 private:
  std::promise<void> begin_;
  std::shared_future<void> begun_ = begin_.get_future().share();
  std::mutex mutex_;
  std::string word_;
};

TEST(LargePlans, RunsAsManyAtOnceAsItMayAndTheClientsTakeTurns) {
  Order order;
  {
    LargePlans plans(1, 1);
    for (const char letter : {'a', 'b', 'c'}) order.post(plans, "greedy", letter);
    order.post(plans, "modest", 'x');
    order.begin();
  }
  EXPECT_EQ(order.word(), "axbc");
}

TEST(LargePlans, OneRunsBesideAnotherThatDoesNotEnd) {
  std::promise<void> first, second;
  LargePlans plans(1, 2);
  plans.post("a", [&] { first.get_future().wait(); });
  plans.post("a", [&] { second.set_value(); });
  second.get_future().wait();
  first.set_value();
}

TEST(LargePlans, ThoseOfJobsGiveWay) {
  std::mutex mutex;
  std::map<std::string, std::set<int>> priorities;
  {
    LargePlans plans(2, 1);
    for (const std::string& client : {background_client("space"), std::string("somebody")}) {
      plans.post(client, [&, client] {
        for_each_index(8, [&](std::size_t) {
          const std::lock_guard lock(mutex);
          priorities[client].insert(::getpriority(PRIO_PROCESS, 0));
        });
      });
    }
  }
  const int ours = ::getpriority(PRIO_PROCESS, 0);
  const int background = std::max(ours, kBackgroundNice);
  EXPECT_EQ(priorities[background_client("space")], std::set<int>{background});
  EXPECT_EQ(priorities["somebody"], std::set<int>{ours});
}

TEST(LargePlans, OfOneClientHaveNoMorePoolsThanTheyMay) {
  std::promise<void> others, release;
  const auto released = release.get_future().share();
  std::atomic<int> greedy{0};
  LargePlans plans(1, 2, 1);
  for (int i = 0; i < 3; ++i) {
    plans.post("greedy", [&] {
      greedy.fetch_add(1);
      released.wait();
    });
  }
  plans.post("modest", [&] { others.set_value(); });
  others.get_future().wait();
  EXPECT_LE(greedy.load(), 1);
  release.set_value();
}

TEST(LargePlans, OfAllJobsLeaveAPoolToOthers) {
  std::promise<void> others, release;
  const auto released = release.get_future().share();
  LargePlans plans(1, 2, 1);
  for (const char* space : {"one", "another"}) {
    plans.post(background_client(space), [released] { released.wait(); });
  }
  plans.post("somebody", [&] { others.set_value(); });
  others.get_future().wait();
  release.set_value();
}

TEST(FairTasks, ClientsTakeTurnsTaskByTask) {
  Order order;
  std::promise<void> begin;
  std::optional<TaskPool> pool(1);
  FairTasks tasks(*pool);
  // The pool is busy until all have been posted.
  pool->post([begun = begin.get_future().share()] { begun.wait(); });
  for (const char letter : {'a', 'b', 'c'}) order.post(tasks, "greedy", letter);
  order.post(tasks, "modest", 'x');
  order.begin();
  begin.set_value();
  pool.reset();  // waits for all: the pool itself need not run them in their order
  EXPECT_EQ(order.word(), "axbc");
}

}  // namespace
}  // namespace tet
