#include "tests/support/lattice_place.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tet::test {

LatticePlace place_on_lattice(const std::array<double, 3>& p) {
  // Rounding moves a vertex by less than 1e-5; within a hundred times that, a node and a point
  // on any of its edges are one.
  constexpr double kAtNode = 1e-3, kOnEdge = 1e-4;
  for (const std::int32_t kind : {kCentre, kCorner}) {
    std::array<std::int32_t, 3> node{}, end{};
    std::array<double, 3> off{};
    for (std::size_t i = 0; i < 3; ++i) {
      node[i] = 2 * static_cast<std::int32_t>(std::lround((p[i] - kind) / 2)) + kind;
      off[i] = std::abs(p[i] - node[i]);
      end[i] = node[i] + (p[i] < node[i] ? -1 : 1);
    }
    const auto place = [&](const std::array<std::int32_t, 3>& other) {
      return LatticePlace{{node[0], node[1], node[2]}, {other[0], other[1], other[2]}, true};
    };
    const auto [shortest, longest] = std::ranges::minmax(off);
    if (longest < kAtNode) return place(node);
    if (longest > 1 - kAtNode && shortest > 1 - kAtNode) continue;  // a node of the other kind
    if (longest - shortest < kOnEdge) return place(end);
    for (std::size_t along = 0; along < 3; ++along) {
      if (std::max(off[(along + 1) % 3], off[(along + 2) % 3]) >= kOnEdge) continue;
      std::array<std::int32_t, 3> next = node;
      next[along] += 2 * (end[along] - node[along]);
      return place(next);
    }
  }
  return {};
}

}  // namespace tet::test
