#include "core/mesh/improve/vertex_stars.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

/// Every hundredth tet.
std::vector<std::uint64_t> some_tets(const TetMesh& mesh) {
  std::vector<std::uint64_t> tets;
  for (std::uint64_t i = 7; i < mesh.header.tet_count; i += 100) tets.push_back(i);
  return tets;
}

std::vector<std::uint64_t> indices(std::span<const TetCorner> star) {
  std::vector<std::uint64_t> all;
  for (const TetCorner corner : star) all.push_back(corner.index);
  return all;
}

TEST(VertexStars, HoldsEveryCornerAroundTheVerticesOfTheChosenTets) {
  const TetMesh mesh = kuhn_mesh(16);
  std::map<std::uint64_t, std::vector<std::uint64_t>> expected;
  for (const std::uint64_t tet : some_tets(mesh)) {
    for (const std::uint64_t vertex : mesh.tet(tet)) expected[vertex];
  }
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto chosen = expected.find(mesh.tet(i)[k]);
      if (chosen != expected.end()) chosen->second.push_back(4 * i + k);
    }
  }

  const VertexStars stars(mesh, some_tets(mesh));
  ASSERT_EQ(stars.size(), expected.size());
  std::size_t next = 0;
  for (const auto& [vertex, corners] : expected) {
    EXPECT_EQ(stars.vertex(next), vertex);
    EXPECT_EQ(stars.number(vertex), next);
    EXPECT_EQ(indices(stars.star(next)), corners);
    ++next;
  }
}

TEST(VertexStars, NumbersNoOtherVertex) {
  const TetMesh mesh = kuhn_mesh(3);
  const VertexStars stars(mesh, std::vector<std::uint64_t>{0});
  std::uint64_t numbered = 0;
  for (std::uint64_t v = 0; v < mesh.header.vertex_count; ++v) {
    numbered += stars.number(v) != VertexStars::kNotChosen;
  }
  EXPECT_EQ(numbered, 4U);
}

TEST(VertexStars, AreTheSameForOneThreadAndForFour) {
  const TetMesh mesh = kuhn_mesh(20);
  const auto stars_on = [&](int threads) {
    std::vector<std::vector<std::uint64_t>> all;
    TaskPool(threads).run([&] {
      const VertexStars stars(mesh, some_tets(mesh));
      for (std::size_t i = 0; i < stars.size(); ++i) all.push_back(indices(stars.star(i)));
    });
    return all;
  };
  EXPECT_TRUE(stars_on(1) == stars_on(4));
}

TEST(IndependentSets, HoldEveryChosenVertexOnceAndNoTwoThatShareATet) {
  const TetMesh mesh = kuhn_mesh(16);
  const VertexStars stars(mesh, some_tets(mesh));
  std::size_t members = 0;
  for (const auto& set : independent_sets(mesh, stars)) {
    EXPECT_FALSE(set.empty());
    EXPECT_TRUE(std::is_sorted(set.begin(), set.end()));
    members += set.size();
    std::set<std::uint64_t> tets;
    for (const std::uint32_t i : set) {
      for (const TetCorner corner : stars.star(i)) {
        EXPECT_TRUE(tets.insert(corner.tet()).second) << "tet " << corner.tet();
      }
    }
  }
  EXPECT_EQ(members, stars.size());
}

}  // namespace
}  // namespace tet
