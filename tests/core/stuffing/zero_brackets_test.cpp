#include "core/stuffing/zero_brackets.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

/// A function on [0, 1] that is negative at one end and positive at the other: nearly straight,
/// as phi is on most edges, or as bent as its power makes it.
struct Crossing {
  double zero = 0, power = 1, scale = 1;

  double at(double t) const { return scale * (std::pow(t, power) - std::pow(zero, power)); }
};

std::vector<Crossing> crossings(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> zero(1e-3, 1 - 1e-3), power(-3, 3), size(-30, 30);
  std::vector<Crossing> made(count);
  for (std::size_t i = 0; i < count; ++i) {
    made[i] = {zero(random), i % 3 == 0 ? 1 : std::exp2(power(random)),
               (i % 2 == 0 ? 1 : -1) * std::exp2(size(random))};
  }
  return made;
}

float zero_alone(const Crossing& of) {
  ZeroBracket bracket;
  bracket.begin(static_cast<double>(static_cast<float>(of.at(0))),
                static_cast<double>(static_cast<float>(of.at(1))));
  for (int step = 0; step < ZeroBracket::kMaxSteps && !bracket.done; ++step) {
    bracket.narrow(of.at(bracket.next));
  }
  return static_cast<float>(bracket.zero());
}

/// Their zeros, each narrowed `steps` times at most.
std::vector<float> zeros_together(const std::vector<Crossing>& of, int steps) {
  std::array<float, ZeroBrackets::kCapacity> at_0, at_1;
  for (std::size_t i = 0; i < of.size(); ++i) {
    at_0[i] = static_cast<float>(of[i].at(0));
    at_1[i] = static_cast<float>(of[i].at(1));
  }
  ZeroBrackets brackets;
  brackets.begin(at_0.data(), at_1.data(), of.size());
  std::vector<float> zeros(of.size(), -1);
  std::array<double, ZeroBrackets::kCapacity> phi;
  for (int step = 0; step < steps && brackets.open() > 0; ++step) {
    for (std::size_t i = 0; i < brackets.open(); ++i) {
      phi[i] = of[brackets.which()[i]].at(brackets.next()[i]);
    }
    brackets.narrow(phi.data(), zeros.data());
  }
  brackets.end(zeros.data());
  EXPECT_EQ(brackets.open(), 0U);
  return zeros;
}

TEST(ZeroBrackets, CloseInOnTheVeryZerosThatBracketsAloneFind) {
  for (const std::size_t count : {1U, 3U, 8U, 16U, 61U, 128U}) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      const std::vector<Crossing> of = crossings(count, seed);
      const std::vector<float> zeros = zeros_together(of, ZeroBracket::kMaxSteps);
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(zeros[i]),
                  std::bit_cast<std::uint32_t>(zero_alone(of[i])))
            << count << " of seed " << seed << ", number " << i;
        EXPECT_NEAR(zeros[i], of[i].zero, 2 * kZeroTolerance);
      }
    }
  }
}

TEST(ZeroBrackets, FindNothingNewWhereTheEndsAloneAreKnown) {
  const std::vector<Crossing> of = crossings(40, 1);
  for (const float zero : zeros_together(of, 0)) EXPECT_TRUE(zero == 0 || zero == 1);
}

TEST(ZeroBrackets, AreDoneAtOnceWherePhiIsZero) {
  const std::array<float, 3> at_0{-1, -1, 2}, at_1{1, 3, -2};
  const std::array<double, 3> phi{0, 0, 0};
  ZeroBrackets brackets;
  brackets.begin(at_0.data(), at_1.data(), 3);
  std::array<float, 3> zeros{};
  brackets.narrow(phi.data(), zeros.data());
  EXPECT_EQ(brackets.open(), 0U);
  EXPECT_EQ(zeros, (std::array<float, 3>{0.5F, 0.25F, 0.5F}));
}

}  // namespace
}  // namespace tet
