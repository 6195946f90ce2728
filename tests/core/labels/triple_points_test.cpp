// Where three labels meet on a face: near what is wished, as far as the tets at it stay good.
#include "core/labels/triple_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/labels/label_cost.h"
#include "core/stuffing/stuffed_lattice.h"
#include "tests/support/label_sources.h"

namespace tet {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();

/// A face and the nodes beyond it on either side.
struct Beside {
  FaceAround face;
  std::array<NodeKind, 2> kind;
  std::array<LatticeCoord, 2> node;
};

Beside face_of(std::size_t family, const std::array<float, 3>& fraction) {
  const FaceFamily& of = kFaceFamily[family];
  Beside beside;
  const LatticeCoord low{of.kind[0], of.kind[0], of.kind[0]};
  for (std::size_t i = 0; i < 3; ++i) beside.face.node[i] = low + of.step[i];
  beside.face.fraction = fraction;
  for (std::size_t side = 0; side < 2; ++side) {
    beside.node[side] = low + of.opposite[side].step;
    beside.kind[side] = of.opposite[side].kind;
    const LatticeCoord sum =
        beside.face.node[0] + beside.face.node[1] + beside.face.node[2] + beside.node[side];
    beside.face.apex[side] = {0.125 * sum.x, 0.125 * sum.y, 0.125 * sum.z};
  }
  return beside;
}

FacePoint mean_of(const std::array<float, 3>& fraction) {
  return put_triple_point(face_of(0, fraction).face, {kNowhere, kNowhere});
}

TEST(FaceFamilies, HaveANodeOnEitherSideThatIsNextToAllOfTheirs) {
  for (std::size_t f = 0; f < kFaceFamilies; ++f) {
    const Beside beside = face_of(f, {});
    for (std::size_t side = 0; side < 2; ++side) {
      EXPECT_EQ(kind_of(beside.node[side]), beside.kind[side]);
      for (const LatticeCoord node : beside.face.node) {
        EXPECT_NE(std::ranges::find(kDirection, beside.node[side] - node), kDirection.end());
      }
    }
    EXPECT_NE(beside.node[0], beside.node[1]);
  }
}

TEST(TriplePoints, AreWhereTheyAreWishedAmidAFace) {
  for (std::size_t f = 0; f < kFaceFamilies; ++f) {
    const FacePoint wished{0.3F, 0.4F};
    EXPECT_EQ(put_triple_point(face_of(f, {0.5F, 0.5F, 0.5F}).face, wished), wished);
  }
}

TEST(TriplePoints, AreAmidTheCutPointsWhereNothingIsWished) {
  const FacePoint mean = mean_of({0.25F, 0.5F, 0.625F});
  EXPECT_FLOAT_EQ(mean.second, (0.25F + 0.5F) / 3);
  EXPECT_FLOAT_EQ(mean.third, (0.5F + 0.625F) / 3);
  const FaceAround face = face_of(0, {0.25F, 0.5F, 0.625F}).face;
  EXPECT_EQ(put_triple_point(face, {std::numeric_limits<float>::infinity(), 0}), mean);
}

TEST(TriplePoints, MeetALineOfZerosOfTwoFunctions) {
  // 1 - b - c = 1/2 and b = 1/8.
  const FacePoint zero = common_zero({0.5, -0.5, -0.5}, {-0.125, 0.875, -0.125});
  EXPECT_FLOAT_EQ(zero.second, 0.125F);
  EXPECT_FLOAT_EQ(zero.third, 0.375F);
  EXPECT_FALSE(std::isfinite(common_zero({1, 1, 1}, {2, 2, 2}).second));
}

/// Whether the six tets over a divided face are good.
bool is_good(const FaceAround& face, const FacePoint& point, const WorldPoint& apex) {
  const WorldPoint at = place_on_face(face.node, point);
  for (std::size_t e = 0; e < 3; ++e) {
    const auto [low, high] = kFaceEdge[e];
    const auto place = [&](std::size_t i) {
      const LatticeCoord n = face.node[i];
      return WorldPoint{0.5 * n.x, 0.5 * n.y, 0.5 * n.z};
    };
    FacePoint on_edge;  // the cut point, by its shares
    const auto add = [&](std::size_t node, float share) {
      if (node == 1) on_edge.second += share;
      if (node == 2) on_edge.third += share;
    };
    add(low, 1 - face.fraction[e]);
    add(high, face.fraction[e]);
    const WorldPoint cut = place_on_face(face.node, on_edge);
    for (const std::size_t node : {low, high}) {
      const double one = tet_cost(place(node), cut, at, apex),
                   other = tet_cost(cut, place(node), at, apex);
      // 1e-6: the cut point's shares are rounded here.
      if (std::min(one, other) > kGoodCost + 1e-6) return false;
    }
  }
  return true;
}

TEST(TriplePoints, AreGoodWithEveryJokerBesideThemOrAmidTheCutPoints) {
  std::mt19937 random(5);
  std::size_t moved = 0, amid = 0;
  for (std::uint32_t round = 0; round < 20'000; ++round) {
    const std::size_t family = random() % kFaceFamilies;
    std::array<float, 3> fraction;
    for (std::size_t e = 0; e < 3; ++e) {
      const float alpha =
          is_long(family_direction(kFaceFamily[family].edge_family[e])) ? 0.2F : 0.3F;
      const float t = static_cast<float>(random() % 257) / 256;
      fraction[e] = std::clamp(t, alpha, 1 - alpha);
    }
    Beside beside = face_of(family, fraction);
    for (std::size_t side = 0; side < 2; ++side) {
      if (random() % 2 == 0) continue;
      const int direction = static_cast<int>(random() % kDirections);
      const float alpha = is_long(direction) ? 0.2F : 0.3F;
      const float t = alpha * static_cast<float>(random() % 257) / 256;
      beside.face.apex[side] = place_of_moved(beside.node[side], direction,
                                              direction < kOwnedDirections ? t : 1 - t);
    }
    const FacePoint wished = test::hostile_triple(round, beside.face.node);
    const FacePoint mean = put_triple_point(beside.face, {kNowhere, kNowhere});
    const FacePoint point = put_triple_point(beside.face, wished);
    if (point == mean) {
      ++amid;
      continue;
    }
    ++moved;
    for (const WorldPoint& apex : beside.face.apex) {
      EXPECT_TRUE(is_good(beside.face, point, apex));
    }
    constexpr double kRounding = 1e-6;
    EXPECT_GE(std::min({double{point.second}, double{point.third},
                        1 - double{point.second} - double{point.third}}),
              kLeastShare - kRounding);
  }
  EXPECT_GT(moved, 10'000U);
  EXPECT_GT(amid, 1'000U);
}

}  // namespace
}  // namespace tet
