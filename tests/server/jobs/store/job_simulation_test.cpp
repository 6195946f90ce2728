// The rules of the queue under accidents of all kinds, from seeds. To play others or more:
//   TET_SEEDS=10000 TET_FIRST_SEED=1 job_simulation_test
// A seed that breaks a promise is named; it breaks it again when it is played alone.
#include "tests/server/jobs/store/job_simulation.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace tet::test {
namespace {

constexpr int kSteps = 120;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* value = std::getenv(name);
  return value ? std::stoull(value) : otherwise;
}

class JobSimulation : public testing::TestWithParam<std::uint64_t> {};

INSTANTIATE_TEST_SUITE_P(Third, JobSimulation, testing::Range<std::uint64_t>(0, 3));

TEST_P(JobSimulation, KeepsEveryPromiseFromEverySeed) {
  const std::uint64_t seeds = from_environment("TET_SEEDS", 300) / 3;
  const std::uint64_t first = from_environment("TET_FIRST_SEED", 1) + GetParam() * seeds;
  Simulated sum;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const Simulated played = simulate(seed, kSteps);
    ASSERT_EQ(played.violation, "") << "seed " << seed;
    sum.commits += played.commits;
    sum.lost_leases += played.lost_leases;
    sum.crashes += played.crashes;
    sum.finished += played.finished;
    sum.dead += played.dead;
  }
  std::printf(
      "%llu seeds: %d jobs finished, %d shards committed, %d dead letters, %d leases lost, "
      "%d crashes\n",
      static_cast<unsigned long long>(seeds), sum.finished, sum.commits, sum.dead,
      sum.lost_leases, sum.crashes);
  // Seeds in which nothing goes wrong would prove nothing.
  EXPECT_GT(sum.lost_leases, 0);
  EXPECT_GT(sum.crashes, 0);
  EXPECT_GT(sum.dead, 0);
}

TEST(JobSimulationTrace, PlaysTheSameFromTheSameSeed) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_EQ(simulate(seed, kSteps).trace, simulate(seed, kSteps).trace);
  }
  EXPECT_NE(simulate(1, kSteps).trace, simulate(2, kSteps).trace);
}

}  // namespace
}  // namespace tet::test
