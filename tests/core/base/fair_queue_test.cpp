#include "core/base/fair_queue.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

constexpr auto kAnyone = [](const std::string&) { return true; };

/// Takes all there is, as one word.
std::string take_all(FairQueue<char>& queue) {
  std::string word;
  while (auto item = queue.take(kAnyone)) word += *item;
  return word;
}

TEST(FairQueue, TakesTurnsOverOwnersAndKeepsTheOrderOfEach) {
  FairQueue<char> queue;
  for (const char c : {'a', 'b', 'c'}) queue.push("greedy", c);
  queue.push("modest", 'x');
  queue.push("other", 'p');
  queue.push("other", 'q');
  EXPECT_EQ(take_all(queue), "axpbqc");
  EXPECT_EQ(queue.size(), 0U);
}

TEST(FairQueue, ALateOwnerWaitsForOneTurnOfEachOther) {
  FairQueue<int> queue;
  for (int i = 0; i < 100; ++i) queue.push("greedy", i);
  queue.take(kAnyone);
  queue.push("late", -1);
  EXPECT_EQ(queue.take(kAnyone), -1);
}

TEST(FairQueue, TheOwnerWhoHasUsedLeastComesNext) {
  using namespace std::chrono_literals;
  FairQueue<char> queue;
  const auto take = [&queue](const std::string& owner, std::chrono::nanoseconds use) {
    const char item = *queue.take(kAnyone);
    queue.charge(owner, use);
    return item;
  };
  for (int i = 0; i < 3; ++i) {
    for (const auto& [owner, letter] : {std::pair("greedy", 'g'), {"large", 'l'}}) {
      queue.push(owner, letter);
    }
  }
  EXPECT_EQ(take("greedy", 10ms), 'g');
  EXPECT_EQ(take("large", 50ms), 'l');
  EXPECT_EQ(take("greedy", 10ms), 'g');
  for (const char c : {'a', 'b'}) queue.push("modest", c);
  EXPECT_EQ(take("modest", 5ms), 'a') << "it begins where the greedy one was, not at nothing";
  EXPECT_EQ(take("modest", 10ms), 'b');
  EXPECT_EQ(take_all(queue), "gll");
}

TEST(FairQueue, NobodySavesUpForLater) {
  using namespace std::chrono_literals;
  FairQueue<char> queue;
  for (int i = 0; i < 100; ++i) {
    queue.push("busy", 'b');
    queue.take(kAnyone);
    queue.charge("busy", 1s);
  }
  for (const char c : {'x', 'y'}) queue.push("idle", c);
  for (const char c : {'b', 'c'}) queue.push("busy", c);
  EXPECT_EQ(*queue.take(kAnyone), 'x');
  queue.charge("idle", 2s);
  EXPECT_EQ(take_all(queue), "bcy");
}

TEST(FairQueue, TheLastOfWhoeverHasMostMakesRoom) {
  FairQueue<char> queue;
  for (const char c : {'a', 'b', 'c'}) queue.push("many", c);
  queue.push("one", 'x');
  EXPECT_EQ(queue.take_last_beyond(2), 'c');
  EXPECT_FALSE(queue.take_last_beyond(2));
  EXPECT_EQ(take_all(queue), "axb");
}

TEST(FairQueue, PassesOverWhoMayNot) {
  FairQueue<int> queue;
  queue.push("a", 1);
  queue.push("b", 2);
  const auto only_b = [](const std::string& owner) { return owner == "b"; };
  EXPECT_EQ(queue.take(only_b), 2);
  EXPECT_FALSE(queue.take(only_b));
  EXPECT_EQ(queue.take(kAnyone), 1);
}

TEST(FairQueue, TakesOutWhatIsChosen) {
  FairQueue<int> queue;
  queue.push("a", 1);
  const auto place = queue.push("a", 2);
  queue.push("b", 3);
  const auto taken = queue.take_all([&](auto at, int) { return at == place; });
  EXPECT_EQ(taken, std::vector<int>{2});
  EXPECT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue.size_of("a"), 1U);
}

}  // namespace
}  // namespace tet
