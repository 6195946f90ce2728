// Tets of three and four labels keep the bounds of both sides, and would not by other rules.
#include "tests/certificate/label_cases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "core/base/tet_geometry.h"
#include "core/labels/label_tables.h"
#include "core/labels/label_tets.h"
#include "core/plan/mesh_request.h"
#include "tests/certificate/certify.h"

namespace tet::certificate {
namespace {

const WarpLimits kLimits = stuffing_rules(Preset::kBothSides).limits;

const AngleBounds kStoredBounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat32);

std::vector<Problem> of_name(const std::vector<Problem>& all, const std::string& name) {
  std::vector<Problem> some;
  std::ranges::copy_if(all, std::back_inserter(some),
                       [&](const Problem& problem) { return problem.name == name; });
  return some;
}

/// Whether both bounds of the preset are proven, as exact positions and as float32.
bool are_proven(const std::vector<Problem>& problems, std::size_t max_boxes) {
  for (const CoordinateType type : {CoordinateType::kFloat64, CoordinateType::kFloat32}) {
    const AngleBounds bounds = angle_bounds(Preset::kBothSides, type);
    Goal goal;
    goal.max_boxes = max_boxes;
    goal.displacement = type == CoordinateType::kFloat32 ? kStoredDisplacement : 0;
    goal.enough_deg = bounds.min_deg;
    if (certify(problems, goal).bound_deg < bounds.min_deg) return false;
    goal.extreme = Extreme::kGreatest;
    goal.enough_deg = bounds.max_deg;
    if (certify(problems, goal).bound_deg > bounds.max_deg) return false;
  }
  return true;
}

TEST(LabelCases, CoverThreeLabelsWithAJokerAndWithoutAndFour) {
  std::set<std::string> names;
  for (const Problem& problem : label_cases(kLimits)) names.insert(problem.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("ABC0", "AABC", "ABCD"));
}

TEST(LabelCases, KeepTheBoundsOfBothSides) {
  const std::vector<Problem> all = label_cases(kLimits);
  for (const std::string name : {"ABC0", "AABC", "ABCD"}) {
    EXPECT_TRUE(are_proven(of_name(all, name), 1'000'000)) << name;
  }
}

/// How far rounding to float32 may turn the angles of a division that is taken where it is
/// good.
double spare_turn() {
  return std::min(kGoodLeast - kStoredBounds.min_deg, kStoredBounds.max_deg - kGoodGreatest);
}

TEST(ChosenLabelCases, AreThoseOfThreeAndFourLabels) {
  const std::vector<Problem> all = chosen_label_cases(kLimits);
  std::map<std::string, std::size_t> most_parameters;
  for (const Problem& problem : all) {
    std::size_t& most = most_parameters[problem.name];
    most = std::max(most, problem.parameter_count);
  }
  const std::map<std::string, std::size_t> expected{{"AABC", 5}, {"ABCD", 6}};
  EXPECT_EQ(most_parameters, expected);
}

TEST(ChosenLabelCases, KeepTheBoundsAsFloat32WhereTheyAreGood) {
  const CertifiedTurn turn =
      certify_turn(chosen_label_cases(kLimits), kStoredDisplacement, spare_turn(), 200'000'000);
  EXPECT_LE(turn.bound_deg, spare_turn());
  EXPECT_GT(turn.attained_deg, 0.5) << "which is not far from what a search finds: 1.6";
}

// The proof must fail where a rule is broken: else it would prove nothing.

/// Whether an angle beyond the bounds of the preset was seen at a single point.
bool is_refuted(const std::vector<Problem>& problems) {
  const AngleBounds bounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat64);
  Goal goal;
  goal.max_boxes = 100'000;
  goal.enough_deg = bounds.min_deg;
  if (certify(problems, goal).attained_deg < bounds.min_deg) return true;
  goal.extreme = Extreme::kGreatest;
  goal.enough_deg = bounds.max_deg;
  return certify(problems, goal).attained_deg > bounds.max_deg;
}

void expect_refuted(const std::vector<Problem>& all, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    EXPECT_TRUE(is_refuted(of_name(all, name))) << name;
  }
}

TEST(LabelCasesFail, WhereCutPointsAreLeftWhereTheyAre) {
  expect_refuted(label_cases(kLimits, LabelRule::kCutsAnywhere), {"ABC0", "AABC", "ABCD"});
}

TEST(LabelCasesFail, WhereTheTriplePointIsACutPoint) {
  expect_refuted(label_cases(kLimits, LabelRule::kTripleAtACut), {"ABC0", "AABC", "ABCD"});
}

TEST(LabelCasesFail, WhereAShorterColumnStartsTheDiagonal) {
  expect_refuted(label_cases(kLimits, LabelRule::kShorterColumn), {"AABC"});
}

TEST(LabelCasesFail, WhereJokersMoveFarther) {
  expect_refuted(label_cases(kLimits, LabelRule::kJokersFarther), {"ABC0"});
}

/// Some of its tets then have no volume at all.
TEST(LabelCasesFail, WhereTheMiddleIsANode) {
  const auto all = label_cases(kLimits, LabelRule::kMiddleAtANode);
  for (const std::string name : {"AABC", "ABCD"}) {
    EXPECT_FALSE(are_proven(of_name(all, name), 100'000)) << name;
  }
}

/// Whether rounding was seen to turn an angle too far at a single point.
bool turns_too_far(const std::vector<Problem>& problems) {
  const CertifiedTurn turn = certify_turn(problems, kStoredDisplacement, spare_turn(), 100'000);
  return turn.attained_deg > spare_turn();
}

TEST(ChosenLabelCasesFail, WhereATriplePointIsACutPoint) {
  const auto all = chosen_label_cases(kLimits, LabelRule::kTripleAtACut);
  for (const std::string name : {"AABC", "ABCD"}) {
    EXPECT_TRUE(turns_too_far(of_name(all, name))) << name;
  }
}

TEST(ChosenLabelCasesFail, WhereTheMiddleIsANode) {
  const auto all = chosen_label_cases(kLimits, LabelRule::kMiddleAtANode);
  for (const std::string name : {"AABC", "ABCD"}) {
    EXPECT_TRUE(turns_too_far(of_name(all, name))) << name;
  }
}

TEST(ChosenLabelCasesFail, WhereCutPointsAreLeftWhereTheyAre) {
  const auto all = chosen_label_cases(kLimits, LabelRule::kCutsAnywhere);
  for (const std::string name : {"AABC", "ABCD"}) {
    const CertifiedTurn turn =
        certify_turn(of_name(all, name), kStoredDisplacement, spare_turn(), 1'000'000);
    EXPECT_GT(turn.bound_deg, spare_turn()) << name;
  }
}

/// Three labels alone: four around their triple points are good wherever they are.
TEST(ChosenLabelCasesFail, WhereADivisionIsTakenWithoutBeingGood) {
  expect_refuted(chosen_label_cases(kLimits), {"AABC"});
}

/// The angles of what the mesher makes of a tet.
struct Angles {
  double least = 180, greatest = 0;
};

/// How far each corner is off its place.
using Offsets = std::array<Vector, kLabelCorners>;

Angles angles_of(const LabelledTet& tet,
                 const LabelDivision& division,
                 const Offsets& off = {}) {
  const LabelPlaces places(tet, {});
  const auto place_of = [&](LabelCorner corner) {
    if (corner < 4) return places.node(corner);
    if (corner < 10) return places.cut(static_cast<std::size_t>(corner - 4));
    if (corner < kLabelMiddle) return places.triple(static_cast<std::size_t>(corner - 10));
    return places.middle(division.middle);
  };
  const auto at = [&](LabelCorner corner) {
    const WorldPoint p = place_of(corner);
    const Vector& d = off[corner];
    return WorldPoint{p.x + d.x, p.y + d.y, p.z + d.z};
  };
  Angles angles;
  for (std::size_t t = 0; t < division.count; ++t) {
    auto [a, b, c, d] = division.tet[t];
    if (tet.shape.negative) std::swap(c, d);
    const auto normal = face_normals(at(a), at(b), at(c), at(d));
    EXPECT_GT(dot(from_to(at(a), at(b)), normal[1]), 0);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine = -dot(normal[i], normal[j]) /
                              std::sqrt(dot(normal[i], normal[i]) * dot(normal[j], normal[j]));
        const double angle = std::acos(cosine) * 180 / std::numbers::pi;
        angles.least = std::min(angles.least, angle);
        angles.greatest = std::max(angles.greatest, angle);
      }
    }
  }
  return angles;
}

TEST(LabelTets, AreGoodForEveryFractionThatIsTried) {
  std::mt19937 random(7);
  const std::array<std::array<Label, 4>, 7> labels{{{1, 2, 3, 4},
                                                    {1, 1, 2, 3},
                                                    {1, 2, 1, 3},
                                                    {1, 2, 3, 1},
                                                    {2, 1, 1, 3},
                                                    {2, 1, 3, 1},
                                                    {2, 3, 1, 1}}};
  LabelDivision division;
  std::set<LabelMiddle> middles;
  for (int round = 0; round < 20'000; ++round) {
    const TetShape& shape = kTetShape[random() % kTetShapes];
    LabelledTet tet{shape, labels[random() % labels.size()], {}};
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      const float alpha = is_long(family_direction(shape.edge_family[e])) ? kLimits.alpha_long
                                                                          : kLimits.alpha_short;
      const float t = static_cast<float>(random() % 1025) / 1024;
      // Half of them at an end, where angles are worst.
      const float share = random() % 2 == 0 ? std::round(t) : t;
      tet.fraction[e] = std::clamp(alpha + share * (1 - 2 * alpha), alpha, 1 - alpha);
    }
    divide(tet, {}, division);
    // As float32 puts them, at worst, along each axis: see kStoredDisplacement.
    Offsets off;
    const auto rounding = [&] { return (random() % 2 == 0 ? 1 : -1) * 0x1p-12; };
    for (Vector& d : off) d = {rounding(), rounding(), rounding()};
    const Angles stored = angles_of(tet, division, off);
    EXPECT_GT(stored.least, kStoredBounds.min_deg + 2);
    EXPECT_LT(stored.greatest, kStoredBounds.max_deg - 5);
    const Angles angles = angles_of(tet, division);
    EXPECT_GT(angles.least, kGoodLeast - 1e-6);
    EXPECT_LT(angles.greatest, kGoodGreatest + 1e-6);
    middles.insert(division.middle);
  }
  EXPECT_THAT(middles, testing::UnorderedElementsAre(
                           LabelMiddle::kNone, LabelMiddle::kOfTriples, LabelMiddle::kOfNodes));
}

}  // namespace
}  // namespace tet::certificate
