// Every tet that the stencils can emit, from the tables the mesher itself reads.
#pragma once

#include <array>
#include <vector>

#include "core/lattice/bcc.h"
#include "core/stuffing/stencil.h"
#include "core/stuffing/stuffed_brick.h"
#include "tests/certificate/problem.h"
#include "tests/certificate/sliding_cases.h"

namespace tet::certificate {

/// A lattice tet after the warp: its signs, and the direction in which each `0` node moved.
struct SignedTet {
  const TetShape& shape;
  std::array<LatticeCoord, 4> node;
  std::array<NodeSign, 4> sign;
  std::array<int, 4> direction;  ///< of `0` nodes
};

/// The first node lies in cell (0, 0, 0) of a brick.
SignedTet unsigned_tet(const TetShape& shape);

/// The tets that one lattice tet may become, in both regions if both are meshed. Named by the
/// signs as its region sees them: `++0-`.
std::vector<Problem> problems_of(const SignedTet& tet,
                                 const StuffingRules& rules,
                                 ColumnRule columns = ColumnRule::kLonger);

/// Those of all lattice tets, up to isometries.
std::vector<Problem> stuffing_cases(const StuffingRules& rules,
                                    ColumnRule columns = ColumnRule::kLonger);

}  // namespace tet::certificate
