#include "core/stuffing/topology/node_regions.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <gtest/gtest.h>

#include "core/lattice/background.h"
#include "core/stuffing/topology/node_link.h"

namespace tet {
namespace {

bool in_star(LatticeCoord node) {
  const int index = node_index(node);
  const Cell at(index);
  const bool in_box = std::ranges::all_of(std::array{at.x, at.y, at.z},
                                          [](int i) { return i >= -1 && i <= 8; });
  return in_box && kBrickStar[kind_of(node)].test(index);
}

/// How often a ring goes from nodes within the star to nodes without: 0 or 1 if those within
/// hang together.
int gaps(const std::array<bool, 6>& within, std::size_t size) {
  int count = 0;
  for (std::size_t i = 0; i < size; ++i) count += within[i] && !within[(i + 1) % size] ? 1 : 0;
  return count;
}

TEST(BrickStar, HasItsEdgesAndFacesInTets) {
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(kBrickStar[kind], [&](int index) {
      const LatticeCoord node = node_coord(kind, index);
      for (std::size_t d = 0; d < kDirections; ++d) {
        if (!in_star(node + kDirection[d])) continue;
        const internal::Ring& ring = kRing[d];
        std::array<bool, 6> within{};
        for (std::size_t i = 0; i < ring.size; ++i) {
          within[i] = in_star(node + kDirection[ring.direction[i]]);
        }
        // The tets around each edge follow one another, and there are some.
        EXPECT_LE(gaps(within, ring.size), 1);
        EXPECT_GE(std::ranges::count(within, true), 2);
      }
    });
  }
}

TEST(FirstRegion, IsAllThatEdgesLeadToButThoseBetweenZeros) {
  // A row of nodes along z; the third and the fourth are zero.
  NodeSets row, zeros;
  for (int z = 1; z < 7; ++z) row[kCorner].set(halo_index(2, 3, z));
  for (const int z : {3, 4}) zeros[kCorner].set(halo_index(2, 3, z));
  const NodePlanes nodes(row);
  EXPECT_EQ(first_region(nodes, {}), nodes);
  const NodePlanes first = first_region(nodes, NodePlanes(zeros));
  EXPECT_EQ(first.sets()[kCorner].count(), 3U);
  EXPECT_TRUE(meet(nodes_beside(first), nodes - first));
}

TEST(NodesBeside, AreTheEndsOfAllEdges) {
  for (const NodeKind kind : {kCorner, kCentre}) {
    const int middle = halo_index(3, 7, 0);
    NodeSets one, ends;
    one[kind].set(middle);
    for (int d = 0; d < kDirections; ++d) {
      ends[end_kind(kind, d)].set(middle + end_offset(kind, d));
    }
    EXPECT_EQ(nodes_beside(NodePlanes(one)), NodePlanes(ends));
  }
}

}  // namespace
}  // namespace tet
