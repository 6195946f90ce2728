#include "tests/certificate/stuffing_cases.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "tests/certificate/isometries.h"

namespace tet::certificate {
namespace {

double alpha_of(const WarpLimits& limits, int direction) {
  return static_cast<double>(is_long(direction) ? limits.alpha_long : limits.alpha_short);
}

SlidingTet sliding(const SignedTet& tet, const WarpLimits& limits) {
  SlidingTet out;
  out.node = tet.node;
  out.negative = tet.shape.negative;
  out.sign = tet.sign;
  for (std::size_t i = 0; i < 4; ++i) {
    out.way[i] = kDirection[static_cast<std::size_t>(tet.direction[i])];
    out.reach[i] = alpha_of(limits, tet.direction[i]);
  }
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    const auto [i, j] = kTetEdge[e];
    out.alpha[i][j] = out.alpha[j][i] =
        alpha_of(limits, family_direction(tet.shape.edge_family[e]));
  }
  return out;
}

bool all_zero(const SignedTet& tet) {
  return std::ranges::count(tet.sign, NodeSign::kZero) == 4;
}

/// Gives the tet every sign and every direction of its `0` nodes in turn.
template <class Visit>
void for_each_sign(SignedTet tet, const Visit& visit) {
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    std::size_t digits = number, combinations = 1;
    for (NodeSign& sign : tet.sign) {
      sign = static_cast<NodeSign>(digits % 3);
      digits /= 3;
      if (sign == NodeSign::kZero) combinations *= kDirections;
    }
    // No table is read for 0000, and all shapes are alike: one will do.
    if (all_zero(tet) && &tet.shape != &kTetShape[0]) continue;
    for (std::size_t combination = 0; combination < combinations; ++combination) {
      std::size_t rest = combination;
      for (std::size_t node = 0; node < 4; ++node) {
        if (tet.sign[node] != NodeSign::kZero) continue;
        tet.direction[node] = static_cast<int>(rest % kDirections);
        rest /= kDirections;
      }
      visit(tet);
    }
  }
}

}  // namespace

SignedTet unsigned_tet(const TetShape& shape) {
  SignedTet tet{shape, {}, {}, {}};
  for (std::size_t i = 0; i < 4; ++i) {
    tet.node[i] = node_coord(shape.kind[i], halo_index(0, 0, 0) + shape.offset[i]);
  }
  return tet;
}

std::vector<Problem> problems_of(const SignedTet& tet,
                                 const StuffingRules& rules,
                                 ColumnRule columns) {
  return problems_of(sliding(tet, rules.limits), rules.both_sides, columns);
}

std::vector<Problem> stuffing_cases(const StuffingRules& rules, ColumnRule columns) {
  std::vector<Problem> problems;
  for (const TetShape& shape : kTetShape) {
    for_each_sign(unsigned_tet(shape), [&](const SignedTet& signed_tet) {
      const SlidingTet tet = sliding(signed_tet, rules.limits);
      if (share_a_cut_point(tet)) return;
      for (Problem& problem : problems_of(tet, rules.both_sides, columns)) {
        problems.push_back(std::move(problem));
      }
    });
  }
  return without_copies(problems);
}

}  // namespace tet::certificate
