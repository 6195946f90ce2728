#include "core/stuffing/topology/node_link.h"

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
