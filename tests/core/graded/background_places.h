// Every place that a tet of a graded background can have among others.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "core/graded/background_mesh.h"
#include "core/lattice/bcc.h"

namespace tet::test {

/// A node of a tet, and all edges that it may have.
struct PlacedNode {
  LatticeCoord at;
  std::int32_t level = 0;  ///< of the smallest leaf around it; the tet's smallest is 0
  BackgroundNode kind = BackgroundNode::kCorner;
  bool in_cut = false;  ///< in a face of the box
  struct Edge {
    LatticeCoord along;
    BackgroundNode to = BackgroundNode::kCorner;
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };
  std::vector<Edge> edges;
  friend auto operator<=>(const PlacedNode&, const PlacedNode&) = default;
};

/// A positive tet, with what its nodes see: doubled spacings of the smallest leaf at one of
/// them.
using PlacedTet = std::array<PlacedNode, 4>;

/// One of all that are alike up to an isometry and the order of nodes, of `trees` random
/// octrees; every other one of them ends at a box where there is a `cut`.
std::vector<PlacedTet> placed_tets(int trees, bool cut);

}  // namespace tet::test
