#include "core/stuffing/node_link.h"

#include <array>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

namespace tet {
namespace {

using Nodes = std::array<HaloSet, kNodeKinds>;

Nodes random_nodes(std::mt19937_64& random) {
  Nodes nodes;
  for (HaloSet& of_kind : nodes) {
    for (std::uint64_t& word : of_kind.word) word = random();
  }
  return nodes;
}

TEST(LinksOfSlice, AreThoseOfItsNodesOneByOne) {
  std::mt19937_64 random(1);
  const Nodes plus = random_nodes(random), zero = random_nodes(random);
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int x = 0; x < 8; ++x) {
      const LinksOfSlice links(plus, zero, kind, x);
      for (int y = 0; y < 8; ++y) {
        for (int z = 0; z < 8; ++z) {
          const NodeLink link = link_of(plus, zero, kind, halo_index(x, y, z));
          EXPECT_EQ(links.at(y, z).plus, link.plus);
          EXPECT_EQ(links.at(y, z).zero, link.zero);
        }
      }
    }
  }
}

TEST(Link, HasTheEndsOfItsNodesEdges) {
  std::mt19937_64 random(2);
  const Nodes plus = random_nodes(random);
  const int node = halo_index(7, 0, 3);
  for (const NodeKind kind : {kCorner, kCentre}) {
    const NodeLink link = link_of(plus, {}, kind, node);
    for (int d = 0; d < kDirections; ++d) {
      EXPECT_EQ((link.plus >> d & 1) != 0,
                plus[end_kind(kind, d)].test(node + end_offset(kind, d)));
    }
  }
}

}  // namespace
}  // namespace tet
