// The part of the proof for graded surfaces that takes no time.
#include "tests/certificate/graded_cases.h"

#include <cstddef>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "tests/certificate/certify.h"

namespace tet::certificate {
namespace {

constexpr NodeSign kPlus = NodeSign::kPlus, kZero = NodeSign::kZero, kMinus = NodeSign::kMinus;

/// What every background tet may become whose nodes have these signs, in their order.
std::vector<Problem> cases_of(std::size_t number, const GradedLimits& limits) {
  std::vector<Problem> problems;
  for (const test::PlacedTet& tet : test::placed_tets(2, false)) {
    for_each_graded_case(tet, number, limits, [&](std::vector<Problem> more) {
      std::move(more.begin(), more.end(), std::back_inserter(problems));
    });
  }
  return problems;
}

bool proven(std::size_t number, const GradedLimits& limits = kGradedLimits) {
  const std::vector<Problem> problems = cases_of(number, limits);
  EXPECT_FALSE(problems.empty());
  Goal goal;
  goal.enough_deg = kLeastGradedAngleDeg;
  goal.max_boxes = 1'000'000;
  return certify(problems, goal).bound_deg >= kLeastGradedAngleDeg;
}

TEST(GradedCases, AreOfSixTets) { EXPECT_EQ(test::placed_tets(2, false).size(), 6U); }

TEST(GradedCases, AreOfTwentyOneWhereABoxCutsThem) {
  EXPECT_EQ(test::placed_tets(8, true).size(), 21U);
}

TEST(GradedCases, KeepTheirBoundWhereItIsQuicklySeen) {
  EXPECT_TRUE(proven(stencil_number(kPlus, kMinus, kMinus, kMinus)));
  EXPECT_TRUE(proven(stencil_number(kPlus, kPlus, kPlus, kMinus)));
  EXPECT_TRUE(proven(stencil_number(kPlus, kPlus, kZero, kZero)));
}

TEST(GradedCases, DoNotWithLimitsThatLetLargeLeavesMoveSmallOnes) {
  GradedLimits limits = kGradedLimits;
  limits.corner_to_far_corner = limits.corner_to_far_centre = 0.45;
  EXPECT_FALSE(proven(stencil_number(kPlus, kPlus, kZero, kZero), limits));
}

TEST(GradedCases, DoNotWithCutPointsNearTheirNodes) {
  GradedLimits limits = kGradedLimits;
  limits.corner_to_far_corner = limits.corner_to_far_centre = 0.05;
  EXPECT_FALSE(proven(stencil_number(kPlus, kMinus, kMinus, kMinus), limits));
}

}  // namespace
}  // namespace tet::certificate
