#include "core/second_order/curved_tet.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "core/second_order/middle_nodes.h"

namespace tet {
namespace {

/// A random tet whose middle nodes lie off by up to `bend`.
TenNodes random_nodes(std::mt19937& random, double bend) {
  std::uniform_real_distribution<double> place(-1, 1);
  TenNodes node;
  for (std::size_t i = 0; i < 4; ++i) node[i] = {place(random), place(random), place(random)};
  for (std::size_t e = 0; e < 6; ++e) {
    const WorldPoint &a = node[kTetEdges[e][0]], &b = node[kTetEdges[e][1]];
    node[4 + e] = {(a.x + b.x) / 2 + bend * place(random),
                   (a.y + b.y) / 2 + bend * place(random),
                   (a.z + b.z) / 2 + bend * place(random)};
  }
  return node;
}

std::array<double, 4> random_shares(std::mt19937& random) {
  std::exponential_distribution<double> weight(1);
  std::array<double, 4> shares{};
  for (double& share : shares) share = weight(random);
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= sum;
  return shares;
}

/// Where a place of the tet lies, by the functions of its ten nodes.
WorldPoint place_at(const TenNodes& node, const std::array<double, 4>& s) {
  std::array<double, 10> weight{};
  for (std::size_t i = 0; i < 4; ++i) weight[i] = s[i] * (2 * s[i] - 1);
  for (std::size_t e = 0; e < 6; ++e)
    weight[4 + e] = 4 * s[kTetEdges[e][0]] * s[kTetEdges[e][1]];
  WorldPoint p;
  for (std::size_t i = 0; i < 10; ++i) {
    p = {p.x + weight[i] * node[i].x, p.y + weight[i] * node[i].y, p.z + weight[i] * node[i].z};
  }
  return p;
}

TEST(CurvedTet, HasTheJacobianThatDifferencesSay) {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const TenNodes node = random_nodes(random, 0.3);
    const auto shares = random_shares(random);
    constexpr double kStep = 1e-6;
    std::array<Vector, 3> along{};
    for (std::size_t k = 0; k < 3; ++k) {
      auto ahead = shares, behind = shares;
      ahead[k + 1] += kStep;
      ahead[0] -= kStep;
      behind[k + 1] -= kStep;
      behind[0] += kStep;
      const WorldPoint p = place_at(node, ahead), q = place_at(node, behind);
      along[k] = {(p.x - q.x) / (2 * kStep), (p.y - q.y) / (2 * kStep),
                  (p.z - q.z) / (2 * kStep)};
    }
    EXPECT_NEAR(jacobian_at(node, shares), dot(cross(along[0], along[1]), along[2]), 1e-7);
  }
}

TEST(CurvedTet, IsNowhereBelowItsLeastCoefficient) {
  std::mt19937 random(4);
  for (int i = 0; i < 300; ++i) {
    const TenNodes node = random_nodes(random, 0.4);
    const double least = least_jacobian(node);
    for (int sample = 0; sample < 300; ++sample) {
      EXPECT_GE(jacobian_at(node, random_shares(random)), least - 1e-12);
    }
  }
}

TEST(CurvedTet, HasItsCornersJacobiansAmongTheCoefficients) {
  std::mt19937 random(5);
  const TenNodes node = random_nodes(random, 0.3);
  const JacobianCoefficients all = jacobian_coefficients(node);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    std::array<double, 4> shares{};
    shares[corner] = 1;
    const double at = jacobian_at(node, shares);
    EXPECT_TRUE(std::ranges::any_of(all, [&](double c) { return std::abs(c - at) < 1e-12; }));
  }
}

TEST(CurvedTet, ThatIsStraightHasOneJacobian) {
  std::mt19937 random(6);
  const TenNodes node = random_nodes(random, 0);
  const JacobianCoefficients all = jacobian_coefficients(node);
  for (const double coefficient : all) EXPECT_NEAR(coefficient, all[0], 1e-14);
  EXPECT_NEAR(volume_of(node), all[0] / 6, 1e-14);
}

TEST(CurvedTet, HasTheVolumeThatSamplesSay) {
  std::mt19937 random(7);
  const TenNodes node = random_nodes(random, 0.3);
  constexpr int kSamples = 200000;
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) sum += jacobian_at(node, random_shares(random));
  EXPECT_NEAR(volume_of(node), sum / kSamples / 6, 0.01);
}

}  // namespace
}  // namespace tet
