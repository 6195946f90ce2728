#include <algorithm>
#include <set>

#include <gmock/gmock.h>

#include "core/base/quality.h"
#include "core/plan/mesh_request.h"
#include "tests/certificate/background_cases.h"
#include "tests/certificate/certify.h"
#include "tests/certificate/dihedral.h"
#include "tests/certificate/stuffing_cases.h"

namespace tet::certificate {
namespace {

const StuffingRules kRules = stuffing_rules(Preset::kDefault);

StuffingRules with_limits(float alpha_long, float alpha_short) {
  StuffingRules rules = kRules;
  rules.limits = {alpha_long, alpha_short};
  return rules;
}

/// What may come of the rules, which takes a second to list.
const std::vector<Problem>& cases_of_rules() {
  static const std::vector<Problem> cases = stuffing_cases(kRules);
  return cases;
}

std::vector<Problem> named(std::vector<Problem> problems, const std::string& name) {
  std::erase_if(problems, [&](const Problem& problem) { return problem.name != name; });
  return problems;
}

Certified bound(const std::vector<Problem>& problems, Extreme extreme) {
  Goal goal;
  goal.extreme = extreme;
  goal.max_boxes = 200'000;
  return certify(problems, goal);
}

TEST(Interval, RoundsOutward) {
  const RoundUpward upward;
  const Interval third = Interval(1) / Interval(3);
  EXPECT_LT(third.lower(), third.upper());
  EXPECT_LT((third * Interval(3)).lower(), 1);
  EXPECT_GT((third * Interval(3)).upper(), 1);
  const Interval root = sqrt(Interval(2));
  EXPECT_LT(root.lower(), root.upper());
  EXPECT_TRUE(boost::numeric::in(2.0, square(root)));
}

TEST(Interval, EnclosesTheCotangent) {
  const RoundUpward upward;
  EXPECT_TRUE(boost::numeric::in(1.0, cotangent_of(45)));
  EXPECT_TRUE(boost::numeric::in(0.0, cotangent_of(90)));
  EXPECT_TRUE(boost::numeric::in(1.0, square(cotangent_of(135))));
  EXPECT_TRUE(boost::numeric::in(3.0, square(cotangent_of(30))));
  EXPECT_TRUE(boost::numeric::in(1.0, cotangent_of(1.25) * cotangent_of(88.75)));
  for (const double degrees : {1.25, 11.3, 45.0, 90.0, 154.9, 179.0}) {
    EXPECT_LT(width(cotangent_of(degrees)), 1e-10);
    EXPECT_LE(degrees_below(cotangent_of(degrees).upper()), degrees);
    EXPECT_GE(degrees_above(cotangent_of(degrees).lower()), degrees);
  }
}

/// A tet with one corner on a slide, its angles known to the mesher's own meter.
TEST(Dihedral, AgreesWithTheQualityOfMeshes) {
  const RoundUpward upward;
  Tet tet{{{{0, 0, 0}, {}}, {{8, 0, 0}, {}}, {{1, 7, 0}, {}}, {{2, 3, 5}, {}}}};
  tet[3].along[0] = {4, -4, 4};
  Box box{};
  box[0] = Interval(0.25);
  double least = 180, greatest = 0;
  for (std::size_t angle = 0; angle < kAngles; ++angle) {
    const Dihedral at = enclose_dihedral(tet, angle, box, 0);
    ASSERT_TRUE(at.positive);
    least = std::min(least, about_degrees(at.cotangent.upper()));
    greatest = std::max(greatest, about_degrees(at.cotangent.lower()));
  }
  QualityMeter meter;
  constexpr std::array<LocalPoint, 4> kPoints{{{0, 0, 0}, {8, 0, 0}, {1, 7, 0}, {3, 2, 6}}};
  constexpr LocalTet kTet{0, 1, 2, 3};
  meter.add_tets(kPoints.data(), {&kTet, 1});
  EXPECT_NEAR(least, meter.stats().min_dihedral_deg, 1e-9);
  EXPECT_NEAR(greatest, meter.stats().max_dihedral_deg, 1e-9);
}

TEST(Dihedral, KnowsItsSlopes) {
  const RoundUpward upward;
  Tet tet{{{{0, 0, 0}, {}}, {{8, 0, 0}, {}}, {{1, 7, 0}, {}}, {{2, 3, 5}, {}}}};
  for (std::size_t k = 0; k < tet.size(); ++k) {
    tet[k].along[k] = {4, static_cast<int>(k) - 2, -4};
  }
  constexpr double kStep = 0x1p-20;
  for (std::size_t angle = 0; angle < kAngles; ++angle) {
    Box box;
    box.fill(Interval(0.125));
    const Dihedral here = enclose_dihedral(tet, angle, box, 0);
    for (std::size_t k = 0; k < kParameters; ++k) {
      Box ahead = box, behind = box;
      ahead[k] += Interval(kStep);
      behind[k] -= Interval(kStep);
      const Interval difference =
          enclose_cotangent(tet, angle, ahead) - enclose_cotangent(tet, angle, behind);
      EXPECT_NEAR(middle_of(here.slope[k]), middle_of(difference) / (2 * kStep), 1e-6);
    }
  }
}

TEST(Cases, CoverEverySignWithSomethingInside) {
  std::set<std::string> names;
  for (const Problem& problem : cases_of_rules()) {
    names.insert(problem.name);
    EXPECT_EQ(problem.rival.size(), problem.contender.size());
  }
  EXPECT_THAT(names,
              testing::UnorderedElementsAre("++++", "+++0", "++00", "+000", "+++-", "++0-",
                                            "+00-", "++--", "++-- by angle", "+0--", "+---"));
}

TEST(Cases, HoldEveryBackgroundShape) {
  const std::vector<Problem> shapes = background_cases();
  // BCC, bisected, quadrisected, half pyramid; and parts of those in the faces of the domain.
  EXPECT_EQ(shapes.size(), 8U);
  EXPECT_NEAR(bound(shapes, Extreme::kLeast).bound_deg, 19.471, 0.01);
  EXPECT_NEAR(bound(shapes, Extreme::kGreatest).bound_deg, 144.736, 0.01);
}

TEST(Certificate, StaysOnTheSafeSideOfWhatItSaw) {
  const auto problems = named(cases_of_rules(), "+00-");
  const Certified least = bound(problems, Extreme::kLeast);
  EXPECT_LE(least.bound_deg, least.attained_deg);
  EXPECT_GT(least.bound_deg, least.attained_deg - 0.01);
  // Two nodes and a cut point, each a quarter of a spacing away along parallel long edges.
  EXPECT_NEAR(least.attained_deg, about_degrees(5), 1e-4);
}

TEST(Certificate, CountsTheRoundingOfPositions) {
  const auto problems = named(cases_of_rules(), "+00-");
  Goal goal;
  const double exact = certify(problems, goal).bound_deg;
  goal.displacement = kStoredDisplacement;
  const double stored = certify(problems, goal).bound_deg;
  EXPECT_LT(stored, exact - 0.03);
  EXPECT_GT(stored, exact - 0.3);
}

// The proof must fail where a rule is broken: else it would prove nothing.

bool proven(const std::vector<Problem>& problems) {
  const AngleBounds bounds = angle_bounds(Preset::kDefault, CoordinateType::kFloat64);
  Goal goal;
  goal.max_boxes = 200'000;
  goal.enough_deg = bounds.min_deg;
  if (certify(problems, goal).bound_deg < bounds.min_deg) return false;
  goal.extreme = Extreme::kGreatest;
  goal.enough_deg = bounds.max_deg;
  return certify(problems, goal).bound_deg <= bounds.max_deg;
}

TEST(CertificateFails, WhereNodesMayMoveFarther) {
  EXPECT_TRUE(proven(cases_of_rules()));
  EXPECT_FALSE(proven(stuffing_cases(with_limits(0.3F, 0.4F))));
}

TEST(CertificateFails, WhereCutPointsMayLieNearer) {
  EXPECT_FALSE(proven(stuffing_cases(with_limits(0.23F, 0.33F))));
}

TEST(CertificateFails, WhereTheDiagonalStartsAtTheShorterColumn) {
  EXPECT_FALSE(proven(stuffing_cases(kRules, ColumnRule::kShorter)));
}

TEST(CertificateFails, WhereTheSurfaceDiagonalIsAnyOne) {
  auto problems = named(cases_of_rules(), "++-- by angle");
  EXPECT_TRUE(proven(problems));
  for (Problem& problem : problems) problem.rival.clear();
  EXPECT_FALSE(proven(problems));
}

TEST(CertificateFails, WhereTheWorseSurfaceDiagonalIsTaken) {
  auto problems = named(cases_of_rules(), "++-- by angle");
  for (Problem& problem : problems) std::swap(problem.contender, problem.rival);
  EXPECT_FALSE(proven(problems));
}

TEST(CertificateFails, WhereATetIsTurnedInsideOut) {
  auto problems = named(cases_of_rules(), "+---");
  EXPECT_TRUE(proven(problems));
  for (Problem& problem : problems) std::swap(problem.tets[0][2], problem.tets[0][3]);
  EXPECT_FALSE(proven(problems));
}

}  // namespace
}  // namespace tet::certificate
