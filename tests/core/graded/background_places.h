// Every place that a tet of a graded background can have among others.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "core/lattice/bcc.h"

namespace tet::test {

/// A node of a tet, and all edges that it may have.
struct PlacedNode {
  LatticeCoord at;
  std::int32_t level = 0;  ///< of the smallest leaf around it; the tet's smallest is 0
  bool is_centre = false;
  struct Edge {
    LatticeCoord along;
    bool leads_to_centre = false;
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };
  std::vector<Edge> edges;
  friend auto operator<=>(const PlacedNode&, const PlacedNode&) = default;
};

/// A positive tet, with what its nodes see: doubled spacings of the smallest leaf at one of
/// them.
using PlacedTet = std::array<PlacedNode, 4>;

/// One of all that are alike up to an isometry and the order of nodes, of `trees` random
/// octrees.
std::vector<PlacedTet> placed_tets(int trees);

}  // namespace tet::test
