// Tets of three and four labels keep the bounds of both sides, and would not by other rules.
#include "tests/certificate/label_cases.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "core/base/tet_geometry.h"
#include "core/labels/label_cost.h"
#include "core/labels/label_tables.h"
#include "core/labels/label_tets.h"
#include "core/labels/triple_points.h"
#include "core/plan/mesh_request.h"
#include "tests/certificate/certify.h"
#include "tests/certificate/dihedral.h"
#include "tests/support/label_sources.h"

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
    goal.refute = false;
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

// What is taken only where it is good keeps them too, whatever it is.

/// How far rounding to float32 may turn the angles of a tet that is good.
double spare_turn() {
  return std::min(kGoodLeast - kStoredBounds.min_deg, kStoredBounds.max_deg - kGoodGreatest);
}

TEST(GoodTets, KeepTheBoundsAsFloat32) {
  const double turn = greatest_turn_deg(kLeastWidth, kStoredDisplacement);
  EXPECT_LE(turn, spare_turn());
  EXPECT_GT(turn, 2);
}

/// A triangle's least height.
double width_of(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const Vector ab = from_to(a, b), ac = from_to(a, c), bc = from_to(b, c);
  const Vector area = cross(ab, ac);
  const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
  return std::sqrt(dot(area, area) / longest);
}

TEST(GoodTets, TurnNoFasterThanTheWidthsOfTheirFacesAllow) {
  std::mt19937 random(3);
  double nearest = 0;
  const RoundUpward upward;
  for (int round = 0; round < 50'000; ++round) {
    Tet tet;
    std::array<WorldPoint, 4> at;
    // Half of them flat, or with corners on a line, but for little.
    const int steps = round % 2 == 0 ? 48 : 3;
    for (std::size_t i = 0; i < 4; ++i) {
      for (int& v : tet[i].base) {
        v = static_cast<int>(random() % static_cast<unsigned>(steps)) * 12 +
            static_cast<int>(random() % 3);
      }
      at[i] = {static_cast<double>(tet[i].base[0]), static_cast<double>(tet[i].base[1]),
               static_cast<double>(tet[i].base[2])};
    }
    // Angles are in the order of kTetEdge: this one is at the edge 01, of 012 and 013.
    const double width = std::min(width_of(at[0], at[1], at[2]), width_of(at[0], at[1], at[3]));
    if (!(width > 1e-3)) continue;
    const double share = enclose_sensitivity(tet, 0, Box{}, 0).upper() * width / 4;
    EXPECT_LE(share, 1 + 1e-9);
    nearest = std::max(nearest, share);
  }
  EXPECT_GT(nearest, 0.9) << "which is not far from what is claimed";
}

TEST(GoodTetsFail, WhereTheirFacesMayBeNarrower) {
  EXPECT_GT(greatest_turn_deg(0.9 * kLeastWidth, kStoredDisplacement), spare_turn());
  EXPECT_EQ(greatest_turn_deg(2 * kStoredDisplacement, kStoredDisplacement), kInfinity);
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

TEST(LabelCasesFail, WhereTriplePointsAreAnywhereWithoutBeingGood) {
  expect_refuted(label_cases(kLimits, LabelRule::kTripleAnywhere), {"ABC0", "AABC", "ABCD"});
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

/// Points of the faces of three labels: near any that are wished, as the mesher puts them
/// between this tet and its mirror image.
void put_triples(LabelledTet& tet, std::uint32_t seed) {
  const LabelPlaces places(tet, {});
  for (std::size_t i = 0; i < kTetFaces; ++i) {
    const auto [a, b, c] = nodes_of_face(i);
    FaceAround face;
    face.fraction = {tet.fraction[edge_between(a, b)], tet.fraction[edge_between(b, c)],
                     tet.fraction[edge_between(a, c)]};
    std::size_t next = 0;
    for (const std::size_t n : {a, b, c}) {
      face.node[next++] =
          node_coord(tet.shape.kind[n], halo_index(0, 0, 0) + tet.shape.offset[n]);
    }
    face.apex.fill(places.middle(LabelMiddle::kOfNodes));
    tet.triple[i] = put_triple_point(face, test::hostile_triple(seed, face.node));
  }
}

/// Around the mean of the nodes of three labels they may go on to the proven ones.
TEST(LabelTets, AreGoodOrAroundTheirNodesForEveryFractionAndPointThatIsTried) {
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
    put_triples(tet, static_cast<std::uint32_t>(round));
    divide(tet, {}, division);
    // As float32 puts them, at worst, along each axis: see kStoredDisplacement.
    Offsets off;
    const auto rounding = [&] { return (random() % 2 == 0 ? 1 : -1) * 0x1p-12; };
    for (Vector& d : off) d = {rounding(), rounding(), rounding()};
    const Angles stored = angles_of(tet, division, off);
    EXPECT_GT(stored.least, kStoredBounds.min_deg + 1);
    EXPECT_LT(stored.greatest, kStoredBounds.max_deg - 2);
    const Angles angles = angles_of(tet, division);
    constexpr double kAroundNodes = 153.805;  // proven of AABC around the mean of its nodes
    const bool around_nodes = division.middle == LabelMiddle::kOfNodes;
    EXPECT_GT(angles.least, kGoodLeast - 1e-6);
    EXPECT_LT(angles.greatest, (around_nodes ? kAroundNodes : kGoodGreatest) + 1e-6);
    middles.insert(division.middle);
  }
  EXPECT_THAT(middles,
              testing::UnorderedElementsAre(LabelMiddle::kNone, LabelMiddle::kOfTriples,
                                            LabelMiddle::kThreeQuarters, LabelMiddle::kHalfWay,
                                            LabelMiddle::kQuarter, LabelMiddle::kOfNodes));
}

}  // namespace
}  // namespace tet::certificate
