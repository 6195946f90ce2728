#include "server/meshing/plan_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/plan/make/plan_mesh.h"
#include "proto/convert/status.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

PlanCache::Plan ball_plan(double radius = 12) {
  return plan_mesh({.shape = std::make_shared<const Volume>(test::ball(radius))}).value();
}

TEST(PlanCache, HoldsTheLastFew) {
  const PlanCache::Plan plan = ball_plan();
  PlanCache cache(100 * plan->bytes());
  for (const char* name : {"a", "b", "c", "d"}) ASSERT_TRUE(cache.remember(name, plan).ok());
  EXPECT_NE(cache.recall("a"), nullptr);
  ASSERT_TRUE(cache.remember("e", plan).ok());
  EXPECT_NE(cache.recall("a"), nullptr);
  EXPECT_EQ(cache.recall("b"), nullptr) << "the least recently used";
  EXPECT_EQ(cache.bytes(), 4 * plan->bytes());
  cache.forget();
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(PlanCache, GivesAllWhoAskTheFirstPlanOfAName) {
  const PlanCache::Plan first = ball_plan(), second = ball_plan();
  PlanCache cache(100 * first->bytes());
  ASSERT_EQ(cache.remember("a", first)->get(), first.get());
  EXPECT_EQ(cache.remember("a", second)->get(), first.get());
}

TEST(PlanCache, CountsPlansThatAreInUseAndLetsGoOfOthersFirst) {
  const PlanCache::Plan plan = ball_plan();
  PlanCache cache(2 * plan->bytes());
  const auto used = cache.remember("used", plan);
  ASSERT_TRUE(cache.remember("idle", plan).ok());
  const auto second = cache.remember("second", plan);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(cache.recall("idle"), nullptr);
  const absl::Status busy = cache.remember("third", plan).status();
  EXPECT_EQ(reason_of(busy), "SERVER_BUSY") << busy;
}

TEST(PlanCache, CountsMemoryForWorkOnPlansForAsLongAsItIsHeld) {
  const PlanCache::Plan plan = ball_plan();
  PlanCache cache(2 * plan->bytes());
  ASSERT_TRUE(cache.remember("idle", plan).ok());
  auto reserved = cache.reserve(2 * plan->bytes(), "bytes of work");
  ASSERT_TRUE(reserved.ok()) << reserved.status();
  EXPECT_EQ(cache.recall("idle"), nullptr);
  EXPECT_EQ(cache.bytes(), 2 * plan->bytes());
  const absl::Status busy = cache.reserve(1, "bytes of work").status();
  EXPECT_EQ(reason_of(busy), "SERVER_BUSY") << busy;
  EXPECT_THAT(busy.message(), testing::HasSubstr("bytes of work"));
  const absl::Status never = cache.reserve(3 * plan->bytes(), "bytes of work").status();
  EXPECT_EQ(reason_of(never), "LIMIT_EXCEEDED") << never;
  *reserved = nullptr;
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(PlanCache, RefusesForGoodWhatHasNoRoomAlone) {
  const PlanCache::Plan plan = ball_plan();
  PlanCache cache(plan->bytes() - 1);
  EXPECT_EQ(reason_of(cache.remember("a", plan).status()), "LIMIT_EXCEEDED");
}

TEST(MeshPlan, TakesAboutAsMuchMemoryAsItsBricks) {
  const std::uint64_t small = ball_plan(12)->bytes(), large = ball_plan(48)->bytes();
  EXPECT_GT(small, 50'000U);
  EXPECT_GT(large, 8 * small);  // a surface 16 times as large
  EXPECT_LT(large, 32 * small);
}

}  // namespace
}  // namespace tet
