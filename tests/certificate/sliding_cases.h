// Every tet that may stand for one tet with a node inside, from the tables the mesher itself
// reads.
#pragma once

#include <array>
#include <vector>

#include "core/lattice/bcc.h"
#include "core/stuffing/stencil.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

/// A tet of any shape after the warp, its nodes in ascending order: how far the edges between
/// them are free of cut points, and along which edges its `0` nodes may have moved.
struct SlidingTet {
  std::array<LatticeCoord, 4> node{};
  bool negative = false;
  std::array<NodeSign, 4> sign{};
  std::array<LatticeCoord, 4> way{};  ///< of `0` nodes: the edge
  std::array<double, 4> reach{};      ///< and how far at most, as a part of it
  /// No cut point on the edge from node i to j is nearer to i than alpha[i][j], as a part of
  /// it.
  std::array<std::array<double, 4>, 4> alpha{};
};

/// How columns are compared: the second only to see the proof fail.
enum class ColumnRule { kLonger, kShorter };

/// The tets that it may become, in both regions if both are meshed. Named by the signs as its
/// region sees them: `++0-`.
std::vector<Problem> problems_of(const SlidingTet& tet,
                                 bool both_sides,
                                 ColumnRule columns = ColumnRule::kLonger);

/// Whether two `0` nodes moved towards each other: an edge has one cut point, which violates no
/// more than one of its ends, as both limits are below one half.
bool share_a_cut_point(const SlidingTet& tet);

}  // namespace tet::certificate
