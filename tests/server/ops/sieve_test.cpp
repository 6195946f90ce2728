#include "server/ops/sieve.h"

#include <chrono>
#include <optional>

#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;

TEST(Sieve, LetsOneEventThroughASecondAndCountsTheOthers) {
  const Sieve::Clock::time_point start(1h);
  Sieve sieve;
  EXPECT_EQ(sieve.pass(start), 0);
  EXPECT_EQ(sieve.pass(start), std::nullopt);
  EXPECT_EQ(sieve.pass(start + 999ms), std::nullopt);
  EXPECT_EQ(sieve.pass(start + 1s), 2);
  EXPECT_EQ(sieve.pass(start + 1999ms), std::nullopt);
  EXPECT_EQ(sieve.pass(start + 1h), 1);
  EXPECT_EQ(sieve.pass(start + 2h), 0);
}

}  // namespace
}  // namespace tet
