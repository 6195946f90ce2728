#include "server/meshing/send_budget.h"

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;
using Leases = std::deque<std::shared_ptr<SendBudget::Lease>>;

constexpr std::uint64_t kBlock = 100;
const int kWho = 0, kOther = 0;

void ask(SendBudget& budget,
         const std::string& client,
         Leases& leases,
         const void* who = &kWho) {
  budget.ask(who, client, [&](auto lease) { leases.push_back(std::move(lease)); });
}

/// Nobody waits any more when the test ends: what then comes back is given to nobody.
struct Departure {
  SendBudget& budget;
  ~Departure() {
    budget.leave(&kWho);
    budget.leave(&kOther);
  }
};

TEST(SendBudget, GrantsUntilItIsUsedUpAndThenWhatComesBack) {
  SendBudget budget(4 * kBlock, kBlock);
  Leases a, b, c;
  const Departure departure{budget};
  for (int i = 0; i < 2; ++i) ask(budget, "a", a), ask(budget, "b", b);
  ask(budget, "c", c);
  EXPECT_EQ(budget.used_bytes(), 4 * kBlock);
  EXPECT_TRUE(c.empty());
  a.pop_back();
  EXPECT_EQ(c.size(), 1U);
}

TEST(SendBudget, LeavesMostOfItToOtherClients) {
  SendBudget budget(80 * kBlock, kBlock);
  Leases greedy, modest;
  const Departure departure{budget};
  for (int i = 0; i < 100; ++i) ask(budget, "greedy", greedy);
  EXPECT_EQ(greedy.size(), 35U);
  for (int i = 0; i < 100; ++i) ask(budget, "modest", modest);
  EXPECT_EQ(modest.size(), 17U);
  budget.leave(&kWho);
}

TEST(SendBudget, HasRoomForWhoeverComesHoweverManyTookAllThatTheyMay) {
  constexpr int kClients = 20;
  for (const bool in_turns : {false, true}) {
    SendBudget budget(256 * kBlock, kBlock);
    std::vector<Leases> greedy(kClients);
    const Departure departure{budget};
    constexpr int kAsked = 64;
    for (int i = 0; i < kClients * kAsked; ++i) {
      const int client = in_turns ? i % kClients : i / kAsked;
      ask(budget, std::to_string(client), greedy[static_cast<std::size_t>(client)]);
    }
    Leases polite;
    ask(budget, "polite", polite, &kOther);
    ask(budget, "polite", polite, &kOther);
    EXPECT_EQ(polite.size(), 2U);
    for (const Leases& one : greedy) EXPECT_GE(one.size(), 2U);
    EXPECT_LE(budget.used_bytes(), 256 * kBlock);
    budget.leave(&kWho);
  }
}

TEST(SendBudget, KeepsNobodyWaitingWhoHasAsMuchAsOthers) {
  SendBudget budget(40 * kBlock, kBlock);
  std::vector<Leases> greedy(4);
  const Departure departure{budget};
  for (int i = 0; i < 100; ++i) {
    for (std::size_t c = 0; c < greedy.size(); ++c) ask(budget, std::to_string(c), greedy[c]);
  }
  for (const Leases& one : greedy) EXPECT_EQ(one.size(), 7U);
  EXPECT_FALSE(budget.kept_waiting_since(SendBudget::Clock::now() + 1h));
  budget.leave(&kWho);
}

TEST(SendBudget, ClientsTakeTurns) {
  SendBudget budget(2 * kBlock, kBlock);
  Leases a, b, c;
  const Departure departure{budget};
  ask(budget, "a", a);
  ask(budget, "b", b);
  for (int i = 0; i < 50; ++i) ask(budget, "a", a);
  ask(budget, "c", c);
  a.pop_front();
  EXPECT_TRUE(a.empty());
  EXPECT_EQ(c.size(), 1U);
  budget.leave(&kWho);
}

TEST(SendBudget, HasIdleMemoryGivenUpBeforeAnybodyGoesWithout) {
  SendBudget budget(4 * kBlock, kBlock);
  std::shared_ptr<SendBudget::Lease> idle;
  int recalls = 0;
  budget.recall_with([&] {
    ++recalls;
    return std::exchange(idle, nullptr) != nullptr;
  });
  idle = budget.take("a", 2 * kBlock);
  ASSERT_NE(idle, nullptr);
  EXPECT_EQ(recalls, 0);
  EXPECT_NE(budget.take("b", 2 * kBlock), nullptr);
  EXPECT_EQ(recalls, 1);
  EXPECT_EQ(budget.take("b", 3 * kBlock), nullptr);  // there is nothing idle any more
  EXPECT_EQ(recalls, 2);

  idle = budget.take("a", 2 * kBlock);
  Leases b, c;
  const Departure departure{budget};
  for (int i = 0; i < 2; ++i) ask(budget, "b", b);
  EXPECT_NE(idle, nullptr);
  ask(budget, "c", c);
  EXPECT_EQ(c.size(), 1U);
  EXPECT_EQ(idle, nullptr);
}

TEST(SendBudget, IsNotTightForWhatIdles) {
  SendBudget budget(4 * kBlock, kBlock);
  Leases a, b;
  const Departure departure{budget};
  for (int i = 0; i < 2; ++i) ask(budget, "a", a);
  EXPECT_FALSE(budget.is_tight(0));
  ask(budget, "b", b);
  EXPECT_TRUE(budget.is_tight(0));
  EXPECT_FALSE(budget.is_tight(kBlock));
  ask(budget, "b", b);
  EXPECT_TRUE(budget.is_tight(kBlock));
}

TEST(SendBudget, KeepsOnlyWhatIsNeeded) {
  SendBudget budget(2 * kBlock, kBlock);
  Leases a;
  const Departure departure{budget};
  ask(budget, "a", a);
  a.front()->shrink_to(10);
  EXPECT_EQ(budget.used_bytes(), 10U);
  a.clear();
  EXPECT_EQ(budget.used_bytes(), 0U);
}

TEST(SendBudget, ForgetsWhoeverLeaves) {
  SendBudget budget(2 * kBlock, kBlock);
  Leases a, gone;
  const Departure departure{budget};
  for (int i = 0; i < 2; ++i) ask(budget, "a", a);
  ask(budget, "a", gone, &kOther);
  budget.leave(&kOther);
  a.clear();
  EXPECT_TRUE(gone.empty());
  EXPECT_EQ(budget.used_bytes(), 0U);
}

TEST(SendBudget, TellsThatSomebodyIsKeptWaitingUnlessByItsOwnShare) {
  SendBudget budget(4 * kBlock, kBlock);
  const auto soon = SendBudget::Clock::now() + 1h;
  Leases a, b, c;
  const Departure departure{budget};
  for (int i = 0; i < 3; ++i) ask(budget, "a", a);
  EXPECT_FALSE(budget.kept_waiting_since(soon)) << "a has its half";
  for (int i = 0; i < 2; ++i) ask(budget, "b", b);
  ask(budget, "c", c);
  EXPECT_TRUE(budget.kept_waiting_since(soon));
  EXPECT_FALSE(budget.kept_waiting_since(soon - 2h)) << "not for so long";
}

TEST(SendBudget, IsOutlivedByWhatItGranted) {
  Leases a;
  {
    SendBudget budget(4 * kBlock, kBlock);
    ask(budget, "a", a);
  }
  a.clear();
}

}  // namespace
}  // namespace tet
