// What becomes of meshes that find no room among those of other jobs.
#include "server/jobs/work/shard_maker.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "tests/server/jobs/work/workshop.h"

namespace tet::test {
namespace {

/// More than the files of such small meshes take beside their chunks.
constexpr std::uint64_t kBesideChunks = 64 << 10;

TEST(ShardMaker, TellsThatAJobGoesOnOnceItHasFoundRoom) {
  Workshop shop;
  const Job job = shop.create(ball_of(16));
  ASSERT_EQ(shop.do_next(), absl::OkStatus());
  const auto run_in_vain = [&] {
    shop.turn_clock(kLongestRoomPause);
    const ShardLease lease = shop.claim().at(0);
    EXPECT_EQ(lease.chunks.first, 0);
    EXPECT_EQ(reason_of(shop.run(lease)), "RESULTS_FULL");
    return lease;
  };
  const absl::Status why = absl::ResourceExhaustedError("no room");
  shop.give_back_for_room(shop.claim().at(0), why);
  EXPECT_TRUE(shop.get(job).waits_for_room);
  shop.open_results({.budget_bytes = 750'000});  // for one chunk
  const ShardLease lease = run_in_vain();
  EXPECT_FALSE(shop.get(job).waits_for_room) << "its first chunk was stored";
  shop.give_back_for_room(lease, why);
  run_in_vain();
  EXPECT_TRUE(shop.get(job).waits_for_room) << "which needs no room again";
}

/// A mesh is begun, beside which a larger one finds no room, but smaller ones do.
class LargeMesh : public testing::Test {
 protected:
  LargeMesh() {
    const std::uint64_t large = shop_.bytes_of(ball_of(16));
    begun_bytes_ = shop_.bytes_of(ball_of(12));
    small_bytes_ = shop_.bytes_of(ball_of(8));
    shop_.open_results({.budget_bytes = large + small_bytes_ + kBesideChunks});
    shop_.create(ball_of(12));
    EXPECT_EQ(shop_.do_next(), absl::OkStatus());
    begun_ = shop_.claim(10);  // by a worker that takes its time
    large_ = shop_.create(ball_of(16));
    look_in_vain();
  }

  void look_in_vain() {
    const absl::Status found = shop_.do_next();
    EXPECT_EQ(reason_of(found), "RESULTS_FULL") << found;
  }
  /// Until the large one has waited long.
  void become_patient() {
    for (std::int64_t looks = 1; looks < kPatientLooks; ++looks) {
      shop_.turn_clock(kLongestRoomPause);
      look_in_vain();
    }
  }
  bool is_planned(const Job& job) { return shop_.get(job).chunk_count > 0; }

  Workshop shop_;
  std::uint64_t begun_bytes_ = 0, small_bytes_ = 0;
  std::vector<ShardLease> begun_;
  Job large_;
};

TEST_F(LargeMesh, LetsSmallOnesBeBegunForAWhile) {
  const Job small = shop_.create(ball_of(8));
  EXPECT_EQ(shop_.do_next(), absl::OkStatus());
  EXPECT_TRUE(is_planned(small));
}

TEST_F(LargeMesh, HasTheRoomThatItHasLongWaitedForBeforeYoungerOnes) {
  become_patient();
  const Job small = shop_.create(ball_of(8));
  const absl::Status kept = shop_.do_next();
  EXPECT_EQ(reason_of(kept), "RESULTS_FULL");
  EXPECT_THAT(std::string(kept.message()), testing::HasSubstr("or have long waited for"));
  for (const ShardLease& lease : begun_) EXPECT_EQ(shop_.run(lease), absl::OkStatus());
  shop_.turn_clock(kLongestRoomPause);
  EXPECT_EQ(shop_.do_next(), absl::OkStatus());
  EXPECT_TRUE(is_planned(large_));
  EXPECT_FALSE(is_planned(small));
  // Which has what is left beside it.
  const auto of_large = shop_.claim(shop_.get(large_).shard_count);
  EXPECT_EQ(shop_.do_next(), absl::OkStatus());
  EXPECT_TRUE(is_planned(small));
}

TEST_F(LargeMesh, KeepsNoMoreUrgentOneWaiting) {
  become_patient();
  const Job urgent = shop_.create(ball_of(8), 1);
  EXPECT_EQ(shop_.do_next(), absl::OkStatus());
  EXPECT_TRUE(is_planned(urgent));
}

TEST_F(LargeMesh, KeepsNoneWaitingThatIsBegunAlready) {
  become_patient();
  const Job again = shop_.create(ball_of(12));
  EXPECT_EQ(shop_.do_next(), absl::OkStatus());
  EXPECT_TRUE(is_planned(again));
}

TEST_F(LargeMesh, KeepsNoneWaitingThatWouldFindNoRoomByItself) {
  become_patient();
  shop_.open_results({.budget_bytes = begun_bytes_ + small_bytes_ + kBesideChunks});
  const Job small = shop_.create(ball_of(8));
  EXPECT_EQ(shop_.do_next(), absl::OkStatus());
  EXPECT_TRUE(is_planned(small));
}

}  // namespace
}  // namespace tet::test
