#include "core/scene/waves.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tet::scene {
namespace {

TEST(Waves, AreSinesAndCosines) {
  for (int i = -4000; i <= 4000; ++i) {
    const double turns = i / 1024.0, angle = 2 * std::numbers::pi * turns;
    EXPECT_NEAR(sin_of_turns(turns), std::sin(angle), 1e-14) << turns;
    EXPECT_NEAR(cos_of_turns(turns), std::cos(angle), 1e-14) << turns;
  }
}

TEST(Waves, AreExactAtQuarterTurnsHoweverMany) {
  for (const double turns : {0.0, 1.0, -3.0, 1e6, -1e9}) {
    EXPECT_EQ(sin_of_turns(turns), 0);
    EXPECT_EQ(sin_of_turns(turns + 0.5), 0);
    EXPECT_EQ(cos_of_turns(turns + 0.25), 0);
    EXPECT_NEAR(sin_of_turns(turns + 0.25), 1, 2e-16);
    EXPECT_NEAR(cos_of_turns(turns), 1, 2e-16);
  }
}

}  // namespace
}  // namespace tet::scene
