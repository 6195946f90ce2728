// Tets of three and four labels, from the tables that the mesher itself reads.
#pragma once

#include <array>
#include <vector>

#include "core/lattice/bcc.h"
#include "core/stuffing/stuffing_rules.h"
#include "tests/certificate/problem.h"
#include "tests/certificate/sliding_cases.h"

namespace tet::certificate {

/// What of the rules is followed: the others only to see the proof fail.
enum class LabelRule {
  kAsItIs,
  kCutsAnywhere,    ///< cut points between nodes that stay are left where they are
  kTripleAtACut,    ///< the triple point is one of the face's cut points
  kTripleAnywhere,  ///< its shares of the face's nodes are a sixth each, the rest is any one's
  kShorterColumn,   ///< the diagonal of A A B starts at the shorter column
  kMiddleAtANode,   ///< the middle of a fan is its lowest node's place
  kJokersFarther,  ///< jokers move up to half an edge: to cut points that violate the other end
};

/// All tets of three labels and a joker (`ABC0`), and those of three and four labels around the
/// mean of the nodes (`AABC`, `ABCD`), which are taken where no other division is good; each
/// with triple points amid their cut points, which are taken where none nearer to what is
/// wished is good; up to isometries. All others are taken only where they are good, as they are
/// computed: see kGoodLeast.
std::vector<Problem> label_cases(const WarpLimits& limits, LabelRule rule = LabelRule::kAsItIs);

/// Those of one lattice tet of a shape whose nodes have these labels; kJoker, which moved in
/// `direction`, at one of them at most.
std::vector<Problem> label_problems_of(const TetShape& shape,
                                       const std::array<std::uint16_t, 4>& label,
                                       int direction,
                                       const WarpLimits& limits,
                                       LabelRule rule = LabelRule::kAsItIs);

}  // namespace tet::certificate
