#include "core/stuffing/topology/surface_sheet.h"

#include <array>

#include <gtest/gtest.h>

namespace tet {
namespace {

using NodeSets = std::array<HaloSet, kNodeKinds>;

/// Nodes of [-1, 8]^3 where `holds` of their doubled coordinates.
template <class Holds>
NodeSets nodes_where(const Holds& holds) {
  NodeSets nodes;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(halo_cube(-1, 8), [&](int index) {
      if (holds(node_coord(kind, index))) nodes[kind].set(index);
    });
  }
  return nodes;
}

constexpr auto kNowhere = [](LatticeCoord) { return false; };

TEST(SurfaceSheet, IsOneAtAPlane) {
  const NodeSets below = nodes_where([](LatticeCoord at) { return at.x + at.y < 11; });
  const SurfaceSheet sheet = surface_sheet({below, nodes_where(kNowhere)});
  EXPECT_TRUE(sheet.any);
  EXPECT_TRUE(sheet.one);
  // It goes on in the brick one step along z, at place 14, and not in the one along all axes.
  EXPECT_TRUE((sheet.later & 1) != 0);
  EXPECT_FALSE((sheet.later & 1 << 12) != 0);
}

TEST(SurfaceSheet, IsNotOneAtAPlate) {
  const NodeSets plate = nodes_where([](LatticeCoord at) { return at.z > 4 && at.z < 10; });
  const SurfaceSheet sheet = surface_sheet({plate, nodes_where(kNowhere)});
  EXPECT_TRUE(sheet.any);
  EXPECT_FALSE(sheet.one);
}

TEST(SurfaceSheet, IsNothingBesideABrick) {
  // Nodes that no edge leads to from the brick's own.
  const NodeSets beyond = nodes_where([](LatticeCoord at) { return at.x == 17 && at.y == 17; });
  EXPECT_FALSE(surface_sheet({beyond, nodes_where(kNowhere)}).any);
  EXPECT_FALSE(surface_sheet({nodes_where(kNowhere), nodes_where(kNowhere)}).any);
}

TEST(SurfaceSheet, IsNotHeldTogetherByEdgesBetweenZeros) {
  // Two hollows in the inside, joined by nothing but the edge between two zeros.
  const auto hollow = [](LatticeCoord at) {
    return at.x == 8 && at.y == 8 && (at.z == 2 || at.z == 4 || at.z == 6 || at.z == 8);
  };
  const auto zero = [&](LatticeCoord at) { return hollow(at) && (at.z == 4 || at.z == 6); };
  const NodeSets plus = nodes_where([&](LatticeCoord at) { return !hollow(at); });
  EXPECT_FALSE(surface_sheet({plus, nodes_where(zero)}).one);
  EXPECT_TRUE(surface_sheet({plus, nodes_where(kNowhere)}).one);
}

}  // namespace
}  // namespace tet
