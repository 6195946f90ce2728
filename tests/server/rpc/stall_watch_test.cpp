#include "server/rpc/stall_watch.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;

struct Waiter : Stallable {
  std::optional<Clock::time_point> since;
  std::chrono::seconds waited{0};

  std::optional<Clock::time_point> waiting_since() override { return since; }
  void give_up(std::chrono::seconds time) override { waited = time; }
};

TEST(StallWatch, GivesUpWhatWaitsForTooLong) {
  StallWatch watch;
  const auto stalled = std::make_shared<Waiter>(), slow = std::make_shared<Waiter>(),
             busy = std::make_shared<Waiter>();
  const auto now = Stallable::Clock::now();
  stalled->since = now - 7s;
  slow->since = now - 3s;
  for (const auto& call : {stalled, slow, busy}) watch.add(call);
  watch.check(now, 5s);
  EXPECT_EQ(stalled->waited, 7s);
  EXPECT_EQ(slow->waited, 0s);
  EXPECT_EQ(busy->waited, 0s);
}

/// A session between two frames may take longer than one that does not read.
struct Thinker final : Waiter {
  std::optional<Wait> wait(std::chrono::seconds /*limit*/) override { return Wait{*since, 1h}; }
};

TEST(StallWatch, GivesUpWhatHasALimitOfItsOwnBeyondThat) {
  StallWatch watch;
  const auto thinking = std::make_shared<Thinker>(), gone = std::make_shared<Thinker>();
  const auto now = Stallable::Clock::now();
  thinking->since = now - 59min;
  gone->since = now - 61min;
  for (const auto& call : {thinking, gone}) watch.add(call);
  watch.check(now, 5s);
  EXPECT_EQ(thinking->waited, 0s);
  EXPECT_EQ(gone->waited, 61min);
}

TEST(StallWatch, ForgetsCallsThatEnded) {
  StallWatch watch;
  auto gone = std::make_shared<Waiter>();
  gone->since = Stallable::Clock::now() - 1h;
  watch.add(gone);
  const std::weak_ptr<Waiter> was = gone;
  gone.reset();
  EXPECT_TRUE(was.expired());
  watch.check(Stallable::Clock::now(), 1s);
}

}  // namespace
}  // namespace tet
