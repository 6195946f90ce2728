#include "core/stuffing/topology/surface_sheet.h"

#include <cstddef>

#include "core/base/check.h"
#include "core/base/vector_clones.h"
#include "core/lattice/background.h"
#include "core/stuffing/topology/climb.h"
#include "core/stuffing/topology/node_regions.h"

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

/// What the nodes in common with a later brick are in planes of each kind. Where it is no step
/// on along x, they are the same in all planes from x = 0 to 7; else they are in those of 7
/// and 8.
struct LaterBrick {
  bool along_x = false;
  std::array<NodePlane, 4> nodes;  ///< corners and centres of 7, then those of 8
};

/// Whether the planes before x = 7 have the nodes that a `LaterBrick` takes for granted there.
[[maybe_unused]] bool are_as_at_seven(const NodePlanes& common,
                                      NodeKind kind,
                                      bool along_x) noexcept {
  for (int x = NodePlanes::kMin; x < 7; ++x) {
    const bool within = !along_x && x >= 0;
    if (!(common.of(kind, x) == (within ? common.of(kind, 7) : NodePlane()))) return false;
  }
  return true;
}

std::array<LaterBrick, 13> find_later_bricks() noexcept {
  const std::array<NodePlanes, 13> common = nodes_in_common();
  std::array<LaterBrick, 13> bricks;
  for (std::size_t place = 0; place < bricks.size(); ++place) {
    bricks[place].along_x = place >= 4;  // the first four are 14 to 17
    for (const NodeKind kind : {kCorner, kCentre}) {
      bricks[place].nodes[kind] = common[place].of(kind, 7);
      bricks[place].nodes[kNodeKinds + kind] = common[place].of(kind, 8);
      TET_CHECK(are_as_at_seven(common[place], kind, bricks[place].along_x));
    }
  }
  return bricks;
}

/// Some nodes in the planes that matter for later bricks: of all x from 0 to 7 by kind, and
/// those of 7 and 8.
struct PlanesForLater {
  std::array<NodePlane, kNodeKinds> all;
  std::array<NodePlane, 4> last;

  [[gnu::always_inline]] explicit PlanesForLater(const NodePlanes& nodes) noexcept {
    for (const NodeKind kind : {kCorner, kCentre}) {
      for (int x = 0; x < 8; ++x) add(nodes.of(kind, x), all[kind]);
      last[kind] = nodes.of(kind, 7);
      last[kNodeKinds + kind] = nodes.of(kind, 8);
    }
  }
  [[gnu::always_inline]] bool meet(const LaterBrick& brick) const noexcept {
    NodePlane common;
    if (brick.along_x) {
      for (std::size_t i = 0; i < last.size(); ++i) add_common(last[i], brick.nodes[i], common);
    } else {
      for (std::size_t i = 0; i < all.size(); ++i) add_common(all[i], brick.nodes[i], common);
    }
    return (common.word[0] | common.word[1] | common.word[2] | common.word[3]) != 0;
  }

 private:
  [[gnu::always_inline]] static void add(const NodePlane& nodes, NodePlane& sum) noexcept {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w) sum.word[w] |= nodes.word[w];
  }
  [[gnu::always_inline]] static void add_common(const NodePlane& a,
                                                const NodePlane& b,
                                                NodePlane& sum) noexcept {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w) sum.word[w] |= a.word[w] & b.word[w];
  }
};

TET_VECTOR_CLONES
unsigned later_with_both(const std::array<LaterBrick, 13>& bricks,
                         const NodePlanes& plus,
                         const NodePlanes& other) noexcept {
  const PlanesForLater of_plus(plus), of_other(other);
  unsigned later = 0;
  for (unsigned place = 0; place < bricks.size(); ++place) {
    const bool both = of_plus.meet(bricks[place]) && of_other.meet(bricks[place]);
    later |= static_cast<unsigned>(both) << place;
  }
  return later;
}

/// Later bricks with which this one shares both `+` and other nodes: as what they share hangs
/// together, the surface crosses an edge of it.
std::uint16_t later_bricks(const NodePlanes& plus, const NodePlanes& other) noexcept {
  static const std::array<LaterBrick, 13> bricks = find_later_bricks();
  return static_cast<std::uint16_t>(later_with_both(bricks, plus, other));
}

/// The sheet between two sides that hang together.
SurfaceSheet sheet_of(const NodePlanes& inside, const NodePlanes& others) noexcept {
  return {.any = true, .one = true, .later = later_bricks(inside, others)};
}

/// Whether the `+` nodes plainly hang together, and the `-` nodes do.
bool have_plain_sides(const StarSigns& star) noexcept {
  const BoxCorner corner = corner_with_most(star.plus);
  return all_climb_to_one(star.plus, corner) && all_climb_to_one(star.minus, corner.opposite());
}

}  // namespace

SurfaceSheet surface_sheet(const SignedNodes& signs) noexcept {
  const StarSigns star(signs.plus, signs.zero);
  const bool any_minus = star.minus.any();
  if (!star.plus.any() || !(any_minus || star.zero.any())) return {};
  const NodePlanes others = star.minus | star.zero;
  if (have_plain_sides(star)) {
    if (!lone_zeros(star).any()) return sheet_of(star.plus, others);
    return {.any = true, .has_plain_sides = true};
  }
  // A zero among `+` alone has no surface around it.
  const bool one = any_minus && first_region(star.plus, star.zero) == star.plus &&
                   first_region(others, star.zero) == others;
  return one ? sheet_of(star.plus, others) : SurfaceSheet{.any = true};
}

SurfaceSheet sheet_between(const SurfaceRegions& regions) noexcept {
  return sheet_of(regions.inside.front().nodes, regions.others.front().nodes);
}

}  // namespace tet
