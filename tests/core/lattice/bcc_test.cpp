#include "core/lattice/bcc.h"

#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/lattice/background.h"

namespace tet {
namespace {

TEST(Bcc, OwnsEveryEdgeOnceByItsLowerNode) {
  std::set<LatticeCoord> directions(kDirection.begin(), kDirection.end());
  EXPECT_EQ(directions.size(), 14U);
  for (int d = 0; d < kDirections; ++d) {
    const LatticeCoord along = kDirection[static_cast<std::size_t>(d)];
    const LatticeCoord back = kDirection[static_cast<std::size_t>(opposite(d))];
    EXPECT_EQ(along + back, (LatticeCoord{0, 0, 0}));
    EXPECT_EQ(d < kOwnedDirections, (LatticeCoord{0, 0, 0} < along));
  }
}

TEST(Bcc, FindsTheNodeAtTheEndOfEveryEdge) {
  for (const NodeKind kind : {kCorner, kCentre}) {
    const int index = halo_index(3, 4, 5);
    const LatticeCoord node = node_coord(kind, index);
    EXPECT_EQ(node_index(node), index);
    for (int d = 0; d < kDirections; ++d) {
      const LatticeCoord end = node + kDirection[static_cast<std::size_t>(d)];
      EXPECT_EQ(kind_of(end), end_kind(kind, d));
      EXPECT_EQ(node_index(end), index + end_offset(kind, d));
    }
  }
}

TEST(Bcc, FillsSpaceWithTwelveTetsACell) {
  double volume = 0;
  for (const TetShape& shape : kTetShape) {
    std::array<LatticeCoord, 4> node;
    for (std::size_t i = 0; i < 4; ++i) {
      node[i] = node_coord(shape.kind[i], halo_index(0, 0, 0) + shape.offset[i]);
      if (i > 0) {
        EXPECT_LT(node[i - 1], node[i]) << "nodes come in the order of coordinates";
      }
    }
    const std::int64_t six =
        internal::triple_product(node[1] - node[0], node[2] - node[0], node[3] - node[0]);
    EXPECT_EQ(six < 0, shape.negative);
    volume += std::abs(static_cast<double>(six)) / 6 / 8;  // doubled coordinates
  }
  EXPECT_DOUBLE_EQ(volume, 1);
}

TEST(Background, TurnsAroundAFaceCounterClockwiseSeenFromOutside) {
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const LatticeCoord a = face_turn(direction, 0), b = face_turn(direction, 1),
                       c = face_turn(direction, 2);
    // Doubled, so that the cell's centre is whole.
    const auto doubled = [](LatticeCoord p) { return p + p; };
    const LatticeCoord centre{1, 1, 1};
    EXPECT_GT(
        internal::triple_product(doubled(a) - centre, doubled(b) - centre, doubled(c) - centre),
        0)
        << "direction " << direction;
  }
}

}  // namespace
}  // namespace tet
