#include "server/meshing/plan_turns.h"

#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/rpc/background.h"

namespace tet {
namespace {

constexpr PlanTurns::Kinds kKinds{{{std::chrono::milliseconds(1), 10, false},
                                   {std::chrono::milliseconds(2), 20, false},
                                   {std::chrono::milliseconds(3), 30, true}}};

/// Turns on threads like an engine's. `release` lets go of what blocks them.
class PlanTurnsTest : public testing::Test {
 protected:
  ~PlanTurnsTest() override {
    release_.set_value();
    for (const std::future<void>& ended : ended_) ended.wait();  // none moves on any more
    longest_.reset();
    longer_.reset();
    pool_.reset();
  }

  /// Posts work that no turn is enough for but the last, which it fills until the test's end.
  void post_greedy(const std::string& client) {
    const auto end = std::make_shared<std::promise<void>>();
    ended_.push_back(end->get_future());
    turns_.post(client, 1, [this, released = released_, end](const PlanTurn& turn) {
      if (!turn.is_last) return false;
      filling_.fetch_add(1);
      released.wait();
      end->set_value();
      return true;
    });
  }

  std::promise<void> release_;
  const std::shared_future<void> released_ = release_.get_future().share();
  std::atomic<int> filling_{0};
  std::vector<std::future<void>> ended_;
  std::optional<TaskPool> pool_{1};
  FairTasks shortest_{*pool_};
  std::optional<LargePlans> longer_{std::in_place, 1, 1}, longest_{std::in_place, 1, 2, 1};
  PlanTurns turns_{{shortest_, *longer_, *longest_}, kKinds};
};

TEST_F(PlanTurnsTest, AreAsLongAsThePlanTakes) {
  std::vector<std::uint64_t> bytes;
  std::promise<void> made;
  turns_.post("a", 1, [&](const PlanTurn& turn) {
    bytes.push_back(turn.bytes);
    if (turn.is_last) made.set_value();
    return turn.is_last;
  });
  made.get_future().wait();
  EXPECT_EQ(bytes, (std::vector<std::uint64_t>{10, 20, 30}));
  EXPECT_EQ(turns_.cut_short(), 2);
}

TEST_F(PlanTurnsTest, BeginWithWhatThePlanLooksToTake) {
  for (const auto& [bricks, bytes] :
       {std::pair(4096.0, 10), {5e3, 20}, {1e5, 30}, {1e99, 30}}) {
    std::promise<std::uint64_t> first;
    turns_.post("a", bricks, [&](const PlanTurn& turn) {
      first.set_value(turn.bytes);
      return true;
    });
    EXPECT_EQ(first.get_future().get(), static_cast<std::uint64_t>(bytes)) << bricks;
  }
}

TEST_F(PlanTurnsTest, LetOthersByWhoeverLooksCheapAndIsNot) {
  for (int i = 0; i < 10; ++i) {
    post_greedy("greedy");
    post_greedy("greedy " + std::to_string(i));
  }
  for (const double bricks : {1.0, 5e3}) {
    std::promise<void> made;
    turns_.post("modest", bricks, [&](const PlanTurn&) {
      made.set_value();
      return true;
    });
    made.get_future().wait();  // though nothing of the others is
  }
}

TEST_F(PlanTurnsTest, LeaveALongTurnToAnotherClient) {
  for (int i = 0; i < 4; ++i) post_greedy("greedy");
  std::promise<void> made;
  turns_.post("modest", 1, [&](const PlanTurn& turn) {
    if (turn.is_last) made.set_value();
    return turn.is_last;
  });
  made.get_future().wait();
  EXPECT_LE(filling_.load(), 1);
}

TEST_F(PlanTurnsTest, OfJobsMayTakeAsLongAsTheirJobs) {
  std::promise<std::chrono::milliseconds> time;
  turns_.post(background_client("space"), 1e9, [&](const PlanTurn& turn) {
    time.set_value(turn.time);
    return true;
  });
  EXPECT_GT(time.get_future().get(), std::chrono::hours(24 * 30));
}

}  // namespace
}  // namespace tet
