#include "core/stuffing/cut_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "core/volume/volume_reader.h"
#include "tests/core/stuffing/stuff.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

TEST(CutPoints, LieWhereTheTrilinearFieldIsZero) {
  const Volume ball = test::ball(6.3);
  VolumeReader reader(ball);
  double worst = 0;
  int found = 0;
  for (const BrickCoord brick : ball.bricks) {
    const auto stuffed = test::stuff(ball, brick);
    for (int family = 0; family < kEdgeFamilies; ++family) {
      const LatticeCoord along = kDirection[static_cast<std::size_t>(family_direction(family))];
      for_each_bit(stuffed->cuts.cut[static_cast<std::size_t>(family)], [&](int low) {
        const LatticeCoord from = node_coord(family_kind(family), low);
        const double t =
            stuffed->cuts
                .fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(low)];
        const VoxelPoint at{8.0 * brick.x + 0.5 * (from.x + t * along.x),
                            8.0 * brick.y + 0.5 * (from.y + t * along.y),
                            8.0 * brick.z + 0.5 * (from.z + t * along.z)};
        worst = std::max(worst, std::abs(reader.trilinear(at)));
        ++found;
      });
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_LT(worst, 1e-3) << "in voxels";
}

TEST(CutPoints, AreOnlyOnEdgesWithStrictlyOppositeSigns) {
  const Volume field = test::random_signs(16, 11, 3);  // a third of the voxels exactly zero
  const auto stuffed = test::stuff(field, {0, 0, 0});
  const auto& samples = stuffed->samples;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const int direction = family_direction(family);
    const auto& low_phi = kind == kCorner ? samples.corner : samples.centre;
    const auto& high_phi =
        end_kind(kind, direction) == kCorner ? samples.corner : samples.centre;
    const HaloSet own = halo_cube(0, 7);
    for_each_bit(own, [&](int low) {
      const float a = low_phi[static_cast<std::size_t>(low)];
      const float b = high_phi[static_cast<std::size_t>(low + end_offset(kind, direction))];
      const bool opposite = (a < 0 && b > 0) || (a > 0 && b < 0);
      EXPECT_EQ(stuffed->cuts.cut[static_cast<std::size_t>(family)].test(low), opposite);
    });
  }
}

TEST(CutPoints, HaveTheSameBitsSeenFromEveryBrickThatSharesTheEdge) {
  const Volume field = test::random_signs(24, 12);
  const auto here = test::stuff(field, {0, 0, 0});
  for (const BrickCoord there : {BrickCoord{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}) {
    const auto other = test::stuff(field, there);
    const int shift = offset_index(8 * there.x, 8 * there.y, 8 * there.z);
    HaloSet nodes;  // those that both bricks know, by their index here
    for (int x = std::max(-1, 8 * there.x - 1); x <= 8; ++x) {
      for (int y = std::max(-1, 8 * there.y - 1); y <= 8; ++y) {
        for (int z = std::max(-1, 8 * there.z - 1); z <= 8; ++z) nodes.set(halo_index(x, y, z));
      }
    }
    int shared = 0;
    for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
      for_each_bit(nodes & here->cuts.cut[f], [&](int low) {
        ++shared;
        ASSERT_TRUE(other->cuts.cut[f].test(low - shift));
        EXPECT_EQ(here->cuts.fraction[f][static_cast<std::size_t>(low)],
                  other->cuts.fraction[f][static_cast<std::size_t>(low - shift)]);
      });
    }
    EXPECT_GT(shared, 5);
  }
}

}  // namespace
}  // namespace tet
