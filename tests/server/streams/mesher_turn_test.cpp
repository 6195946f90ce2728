#include "server/streams/mesher_turn.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;

constexpr auto kNoDeadline = Admission::Clock::time_point::max();

AdmissionLimits room_for_one() {
  constexpr Share kMany{1000, 1000};
  return {kMany, kMany, {1, 1}, kMany, 10s};
}

class MesherTurnTest : public testing::Test {
 protected:
  /// Gives the turn a place, whose mesh is opened.
  void take_place() {
    admission_.queue_mesh("a", kNoDeadline, [this](absl::StatusOr<Ticket> ticket) {
      ASSERT_TRUE(ticket.ok()) << ticket.status();
      turn_.take(*std::move(ticket));
    });
    turn_.opened();
  }
  void lend() { turn_.lend_if_idle_since(MesherTurn::Clock::time_point::max()); }

  Admission admission_{room_for_one()};
  MesherTurn turn_{admission_};
};

TEST_F(MesherTurnTest, LendsItsPlaceOnceAndComesBackForWork) {
  take_place();
  lend();
  lend();
  EXPECT_EQ(admission_.running_meshes(), 0U);
  EXPECT_EQ(admission_.paused_meshes(), 1U);
  turn_.begin();
  EXPECT_EQ(admission_.running_meshes(), 1U);
  EXPECT_EQ(admission_.paused_meshes(), 0U);
  lend();
  EXPECT_EQ(admission_.paused_meshes(), 0U) << "something is being made";
  turn_.end();
  turn_.give_back();
  EXPECT_EQ(admission_.running_meshes(), 0U);
}

TEST_F(MesherTurnTest, WhoeverGetsThePlaceMayWakeItAndIsToldWithoutItsLock) {
  take_place();
  Ticket others;
  admission_.queue_mesh("b", kNoDeadline, [&](absl::StatusOr<Ticket> ticket) {
    others = *std::move(ticket);
    turn_.begin();  // takes the lock
    turn_.end();
  });
  lend();
  EXPECT_TRUE(others);
  EXPECT_EQ(admission_.paused_meshes(), 0U);
}

// Begun between its being lent and its place being given away, a piece of work took back what
// was not given yet: there were fewer paused meshes than none.
TEST_F(MesherTurnTest, IsLentAndTakenBackAtOnceForWhoeverCounts) {
  take_place();
  std::atomic<bool> over{false};
  std::atomic<std::uint64_t> most{0};
  std::jthread counts([&] {
    while (!over) most = std::max(most.load(), admission_.paused_meshes());
  });
  std::jthread lends([&] {
    while (!over) lend();
  });
  for (int i = 0; i < 50'000; ++i) {
    turn_.begin();
    turn_.end();
  }
  over = true;
  lends.join();
  counts.join();
  EXPECT_LE(most.load(), 1U);
  turn_.give_back();
  EXPECT_EQ(admission_.paused_meshes(), 0U);
}

}  // namespace
}  // namespace tet
