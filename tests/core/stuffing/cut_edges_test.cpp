#include "core/stuffing/cut_edges.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/stuffing/stuff.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

TEST(CutEdges, AreTheSetsFamilyByFamilyInTheOrderOfHaloIndices) {
  for (const int zero_every : {0, 2, 9}) {
    const auto stuffed = test::stuff(test::random_signs(24, 41, zero_every), {0, 0, 0});
    const CutEdges& edges = stuffed->cuts.edges;
    for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
      std::vector<int> expected, found;
      for_each_bit(stuffed->cuts.cut[f], [&](int low) { expected.push_back(low); });
      const auto [begin, count] = edges.run[f];
      for (std::size_t i = begin; i < begin + count; ++i) found.push_back(edges.low[i]);
      EXPECT_TRUE(found == expected);
      for (std::size_t i = begin; i < begin + count; ++i) {
        EXPECT_EQ(edges.fraction[i], stuffed->cuts.fraction[f][edges.low[i]]);
      }
    }
  }
}

TEST(CutEdges, FillEveryRunUpToWholeLanes) {
  const auto stuffed = test::stuff(test::ball(9), {0, 0, 0});
  const CutEdges& edges = stuffed->cuts.edges;
  for (const CutEdges::Run& run : edges.run) {
    EXPECT_EQ(run.begin % kEdgeLanes, 0U);
    EXPECT_EQ(run.padded() % kEdgeLanes, 0U);
    for (std::size_t i = run.count; i < run.padded(); ++i) {
      EXPECT_EQ(edges.low[run.begin + i], edges.low[run.begin + run.count - 1]);
    }
  }
}

TEST(CutEdges, AreAllThoseWithAnEndAmongTheNodesInReach) {
  const auto stuffed = test::stuff(test::random_signs(24, 42, 3), {0, 0, 0});
  const HaloSet nodes = halo_cube(kNodeMin, kNodeMax);
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    const NodeSigns& signs = stuffed->cuts.signs;
    HaloSet expected = (signs.inside[kind] & seen_from(signs.outside[end], offset)) |
                       (signs.outside[kind] & seen_from(signs.inside[end], offset));
    expected &= nodes | seen_from(nodes, offset);
    EXPECT_TRUE(stuffed->cuts.cut[static_cast<std::size_t>(family)].word == expected.word);
  }
}

}  // namespace
}  // namespace tet
