// Every tet that graded surfaces can have, from what octrees make of their backgrounds.
#pragma once

#include <cstddef>
#include <vector>

#include "core/graded/graded_warp.h"
#include "tests/certificate/problem.h"
#include "tests/certificate/sliding_cases.h"
#include "tests/core/graded/background_places.h"

namespace tet::certificate {
namespace internal {

inline double part_of(const test::PlacedNode& node,
                      const test::PlacedNode::Edge& edge,
                      const GradedLimits& limits) {
  return limits.part({node.kind, edge.to, edge.along, node.level});
}

/// The tet without its signs.
inline SlidingTet sliding(const test::PlacedTet& tet, const GradedLimits& limits) {
  SlidingTet out;
  for (std::size_t i = 0; i < 4; ++i) {
    out.node[i] = tet[i].at;
    for (std::size_t j = 0; j < 4; ++j) {
      if (i == j) continue;
      out.alpha[i][j] = part_of(tet[i], {tet[j].at - tet[i].at, tet[j].kind}, limits);
    }
  }
  return out;
}

}  // namespace internal

/// Calls `visit` with what a background tet may become that has the signs of stencil `number`
/// after the warp: a vector of problems for each choice of the edges along which its `0` nodes
/// moved.
template <class Visit>
void for_each_graded_case(const test::PlacedTet& tet,
                          std::size_t number,
                          const GradedLimits& limits,
                          const Visit& visit) {
  SlidingTet sliding = internal::sliding(tet, limits);
  std::size_t combinations = 1;
  for (std::size_t i = 0; i < 4; ++i, number /= 3) {
    sliding.sign[i] = static_cast<NodeSign>(number % 3);
    if (sliding.sign[i] == NodeSign::kZero) combinations *= tet[i].edges.size();
  }
  for (std::size_t combination = 0; combination < combinations; ++combination) {
    std::size_t rest = combination;
    for (std::size_t i = 0; i < 4; ++i) {
      if (sliding.sign[i] != NodeSign::kZero) continue;
      const test::PlacedNode::Edge& edge = tet[i].edges[rest % tet[i].edges.size()];
      rest /= tet[i].edges.size();
      sliding.way[i] = edge.along;
      sliding.reach[i] = internal::part_of(tet[i], edge, limits);
    }
    if (!share_a_cut_point(sliding)) visit(problems_of(sliding, false));
  }
}

}  // namespace tet::certificate
