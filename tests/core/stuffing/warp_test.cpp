#include "core/stuffing/warp.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <gtest/gtest.h>

#include "tests/core/stuffing/stuff.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

constexpr double kShortLength = 0.86602540378443864676;

/// Distance from a node along `direction` to that edge's cut point, in units of the edge; or 2.
double distance_along(const CutPoints& cuts, NodeKind kind, int node, int direction) {
  if (direction < kOwnedDirections) {
    const auto f = static_cast<std::size_t>(edge_family(kind, direction));
    return cuts.cut[f].test(node) ? cuts.fraction[f][static_cast<std::size_t>(node)] : 2;
  }
  const int low = node + end_offset(kind, direction);
  const auto f =
      static_cast<std::size_t>(edge_family(end_kind(kind, direction), opposite(direction)));
  return cuts.cut[f].test(low) ? 1 - cuts.fraction[f][static_cast<std::size_t>(low)] : 2;
}

TEST(Warp, MovesExactlyTheViolatedNodesOntoTheirNearestViolatingCutPoint) {
  const WarpLimits limits;
  for (const int zero_every : {0, 3}) {
    const auto stuffed = test::stuff(test::random_signs(16, 21, zero_every), {0, 0, 0}, limits);
    for (const NodeKind kind : {kCorner, kCentre}) {
      for_each_bit(halo_cube(kNodeMin, kNodeMax), [&](int node) {
        int nearest = -1;
        double least = 2;
        for (int d = 0; d < kDirections; ++d) {
          const double along = distance_along(stuffed->cuts, kind, node, d);
          const double alpha =
              static_cast<double>(is_long(d) ? limits.alpha_long : limits.alpha_short);
          if (along >= alpha) continue;
          const double distance = along * (is_long(d) ? 1 : kShortLength);
          if (distance < least - 1e-7) {
            least = distance;
            nearest = d;
          }
        }
        ASSERT_EQ(stuffed->warped.warped[kind].test(node), nearest >= 0);
        if (nearest < 0) return;
        EXPECT_EQ(stuffed->warped.direction[kind][static_cast<std::size_t>(node)], nearest);
        EXPECT_TRUE(stuffed->warped.zero[kind].test(node));
        EXPECT_FALSE(stuffed->warped.plus[kind].test(node));
      });
    }
  }
}

TEST(Warp, ForgetsTheBrickBefore) {
  const auto before = test::stuff(test::random_signs(16, 31), {0, 0, 0});
  for (const std::uint32_t seed : {32U, 33U}) {
    const auto alone = test::stuff(test::random_signs(16, seed), {0, 0, 0});
    WarpedLattice& lattice = before->warped;
    warp_lattice(alone->cuts, {}, lattice);
    for (const NodeKind kind : {kCorner, kCentre}) {
      for_each_bit(kKnownNodes, [&](int node) {
        const auto at = static_cast<std::size_t>(node);
        ASSERT_EQ(lattice.plus[kind].test(node), alone->warped.plus[kind].test(node));
        ASSERT_EQ(lattice.zero[kind].test(node), alone->warped.zero[kind].test(node));
        ASSERT_EQ(lattice.direction[kind][at], alone->warped.direction[kind][at]);
      });
    }
  }
}

TEST(NearestCuts, HaveNumbersBelowThoseOfEveryBrickBefore) {
  const auto nearest = std::make_unique<NearestCuts>();
  constexpr std::size_t kNumbers = std::size_t{kNodeKinds} * kHaloNodes;
  std::uint64_t last = nearest->begin_brick();
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < kNumbers; ++i) nearest->data()[i] = last;
    std::uint64_t next = nearest->begin_brick();
    for (; next < last; next = nearest->begin_brick()) last = next;
    // There are no lower ones: all nodes begin anew.
    for (std::size_t i = 0; i < kNumbers; ++i) ASSERT_GT(nearest->data()[i], next);
    last = next;
  }
}

TEST(Warp, LeavesNoCutPointOnAnEdgeWithAZeroEnd) {
  const auto stuffed = test::stuff(test::random_signs(16, 22, 4), {0, 0, 0});
  int kept = 0;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const int direction = family_direction(family);
    for_each_bit(stuffed->warped.cut[static_cast<std::size_t>(family)], [&](int low) {
      ++kept;
      EXPECT_FALSE(stuffed->warped.zero[kind].test(low));
      EXPECT_FALSE(stuffed->warped.zero[end_kind(kind, direction)].test(
          low + end_offset(kind, direction)));
    });
  }
  EXPECT_GT(kept, 100);
}

TEST(Warp, DecidesTheSameInEveryBrickThatSeesANode) {
  const Volume field = test::random_signs(24, 23, 5);
  const auto here = test::stuff(field, {0, 0, 0}), there = test::stuff(field, {1, 1, 0});
  const int shift = offset_index(8, 8, 0);
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int z = kNodeMin; z <= kNodeMax; ++z) {
      for (const int x : {7, 8}) {
        for (const int y : {7, 8}) {
          const int node = halo_index(x, y, z);
          EXPECT_EQ(here->warped.zero[kind].test(node),
                    there->warped.zero[kind].test(node - shift));
          EXPECT_EQ(here->warped.plus[kind].test(node),
                    there->warped.plus[kind].test(node - shift));
        }
      }
    }
  }
}

}  // namespace
}  // namespace tet
