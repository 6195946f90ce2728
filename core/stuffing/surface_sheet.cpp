#include "core/stuffing/surface_sheet.h"

#include <cstddef>

#include "core/lattice/background.h"
#include "core/stuffing/node_regions.h"

namespace tet {
namespace {

/// What of [-1, 8] two bricks have in common that are `step` bricks apart along an axis.
struct Common {
  int min, max;
  constexpr explicit Common(int step)
      : min(step == 0 ? 0 : (step < 0 ? -1 : 7)), max(step == 0 ? 7 : min + 1) {}
};

/// Whether a node lies where this brick and one that is a step along each axis away meet.
bool lies_between(int index, const std::array<int, 3>& step) noexcept {
  const Cell at(index);
  const auto within = [](const Common& common, int i) {
    return i >= common.min && i <= common.max;
  };
  return within(Common(step[0]), at.x) && within(Common(step[1]), at.y) &&
         within(Common(step[2]), at.z);
}

/// For each later brick, at the places 14 .. 26, the nodes between the two that are in the
/// stars of both: all ends of edges from one to the other, and they hang together.
std::array<NodePlanes, 13> nodes_in_common() noexcept {
  std::array<NodePlanes, 13> common;
  for (int place = 14; place < 27; ++place) {
    const std::array<int, 3> step{place / 9 - 1, place / 3 % 3 - 1, place % 3 - 1};
    const int to_other = 8 * offset_index(step[0], step[1], step[2]);
    NodeSets nodes;
    for (const NodeKind kind : {kCorner, kCentre}) {
      for_each_bit(kBrickStar[kind], [&](int index) {
        if (!lies_between(index, step)) return;
        if (kBrickStar[kind].test(index - to_other)) nodes[kind].set(index);
      });
    }
    common[static_cast<std::size_t>(place - 14)] = NodePlanes(nodes);
  }
  return common;
}

/// Later bricks with which this one shares both `+` and other nodes: as what they share hangs
/// together, the surface crosses an edge of it.
std::uint16_t later_bricks(const NodePlanes& plus, const NodePlanes& other) noexcept {
  static const std::array<NodePlanes, 13> common = nodes_in_common();
  unsigned later = 0;
  for (unsigned place = 0; place < common.size(); ++place) {
    const bool both = meet(plus, common[place]) && meet(other, common[place]);
    later |= static_cast<unsigned>(both) << place;
  }
  return static_cast<std::uint16_t>(later);
}

}  // namespace

SurfaceSheet surface_sheet(const NodeSets& plus, const NodeSets& zero) noexcept {
  const NodePlanes in_plus = NodePlanes::in_star(plus), in_zero = NodePlanes::in_star(zero);
  const NodePlanes other = NodePlanes(kBrickStar) - in_plus;
  SurfaceSheet sheet;
  sheet.any = in_plus.any() && other.any();
  if (!sheet.any) return sheet;
  // A zero among `+` alone has no surface around it.
  sheet.one = (other - in_zero).any() && first_region(in_plus, in_zero) == in_plus &&
              first_region(other, in_zero) == other;
  if (sheet.one) sheet.later = later_bricks(in_plus, other);
  return sheet;
}

SurfaceSheet sheet_between(const SurfaceRegions& regions) noexcept {
  return {.any = true,
          .one = true,
          .later = later_bricks(regions.inside.front().nodes, regions.others.front().nodes)};
}

}  // namespace tet
