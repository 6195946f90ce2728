#include "server/shared_memory/kept_memory.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;

constexpr RingSize kRing{2, 4096};

std::shared_ptr<SideConnection> some_connection() {
  return std::make_shared<SideConnection>(Descriptor(), "token");
}

class KeptMemoryTest : public testing::Test {
 protected:
  /// Memory whose charge `charge_` tells of.
  std::shared_ptr<RingMemory> made(const std::string& client = "somebody") const {
    auto memory = RingMemory::make(kRing, Readers::kAny, client, charge_);
    EXPECT_TRUE(memory.ok()) << memory.status();
    return *std::move(memory);
  }
  long charges() const { return charge_.use_count() - 1; }

  const std::shared_ptr<int> charge_ = std::make_shared<int>();
  const std::shared_ptr<SideConnection> one_ = some_connection(), other_ = some_connection();
  KeptMemory kept_{2 * kRing.bytes()};
};

TEST_F(KeptMemoryTest, IsItsConnectionsAndItsClientsAlone) {
  kept_.keep(one_, made());
  EXPECT_EQ(kept_.take(other_, "somebody", kRing), nullptr);
  EXPECT_EQ(kept_.bytes(), kRing.bytes());
  EXPECT_NE(kept_.take(one_, "somebody", kRing), nullptr);
  EXPECT_EQ(kept_.take(one_, "somebody", kRing), nullptr);  // once
  EXPECT_EQ(charges(), 0);

  kept_.keep(one_, made());
  EXPECT_EQ(kept_.take(one_, "somebody else", kRing), nullptr);
  EXPECT_EQ(charges(), 0);
}

TEST_F(KeptMemoryTest, ServesWhoeverWantsNoMore) {
  kept_.keep(one_, made());
  EXPECT_NE(kept_.take(one_, "somebody", {1, 4096}), nullptr);
  for (const RingSize more : {RingSize{3, 4096}, RingSize{2, 8192}}) {
    kept_.keep(one_, made());
    EXPECT_EQ(kept_.take(one_, "somebody", more), nullptr);
    EXPECT_EQ(kept_.bytes(), 0u);
    EXPECT_EQ(charges(), 0);
  }
}

TEST_F(KeptMemoryTest, StaysWithinItsBytesAndTheOldestGoes) {
  const auto third = some_connection();
  for (const auto& connection : {one_, other_, third}) kept_.keep(connection, made());
  EXPECT_EQ(kept_.bytes(), 2 * kRing.bytes());
  EXPECT_EQ(charges(), 2);
  EXPECT_EQ(kept_.take(one_, "somebody", kRing), nullptr);
  EXPECT_NE(kept_.take(third, "somebody", kRing), nullptr);
  KeptMemory none(kRing.bytes() - 1);
  none.keep(one_, made());
  EXPECT_EQ(none.bytes(), 0u);
}

TEST_F(KeptMemoryTest, IsGivenUpWhenIdleOrItsConnectionIsGone) {
  auto gone = some_connection();
  kept_.keep(one_, made());
  kept_.keep(gone, made());
  const auto now = KeptMemory::Clock::now();
  kept_.give_up_idle(now);
  EXPECT_EQ(charges(), 2);
  gone.reset();
  kept_.give_up_idle(now);
  EXPECT_EQ(charges(), 1);
  kept_.give_up_idle(now + KeptMemory::kIdle + 1s);
  EXPECT_EQ(charges(), 0);
  EXPECT_EQ(kept_.bytes(), 0u);
}

TEST_F(KeptMemoryTest, IsGivenUpAllAtOnce) {
  EXPECT_FALSE(kept_.give_up_all());
  kept_.keep(one_, made());
  kept_.keep(other_, made());
  EXPECT_TRUE(kept_.give_up_all());
  EXPECT_EQ(kept_.bytes(), 0u);
  EXPECT_EQ(charges(), 0);
}

}  // namespace
}  // namespace tet
