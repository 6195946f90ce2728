#include "core/stuffing/restored_nodes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tet {
namespace {

/// Moves the cut points at `edges` of a family into [alpha, 1 - alpha].
void clear_ends(const HaloSet& edges,
                int family,
                const WarpLimits& limits,
                CutPoints& cuts) noexcept {
  const auto f = static_cast<std::size_t>(family);
  const float alpha =
      is_long(family_direction(family)) ? limits.alpha_long : limits.alpha_short;
  for_each_bit(edges, [&](int low) {
    float& fraction = cuts.fraction[f][static_cast<std::size_t>(low)];
    // Where a sample is exactly zero the edge had no cut point at all.
    fraction = cuts.cut[f].test(low) ? std::clamp(fraction, alpha, 1 - alpha) : 0.5F;
  });
}

}  // namespace

RestoredNodes::RestoredNodes(std::vector<BrickCoord> bricks, std::vector<NodeMasks> nodes)
    : bricks_(std::move(bricks)), nodes_(std::move(nodes)), index_(bricks_) {}

std::uint64_t RestoredNodes::count() const noexcept {
  std::uint64_t count = 0;
  for (const auto& nodes : nodes_) count += nodes[kCorner].count() + nodes[kCentre].count();
  return count;
}

std::array<HaloSet, kNodeKinds> RestoredNodes::around(BrickCoord brick) const noexcept {
  std::array<HaloSet, kNodeKinds> around;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const std::uint32_t at = index_.find({brick.x + x, brick.y + y, brick.z + z});
        if (at == kNoBrick) continue;
        for (const NodeKind kind : {kCorner, kCentre}) {
          add_brick(around[kind], nodes_[at][kind], x, y, z);
        }
      }
    }
  }
  return around;
}

void restore_nodes(const std::array<HaloSet, kNodeKinds>& restored,
                   const WarpLimits& limits,
                   StuffedLattice& lattice) noexcept {
  WarpedLattice& warped = lattice.warped;
  std::array<HaloSet, kNodeKinds> back, nonzero;
  for (const NodeKind kind : {kCorner, kCentre}) {
    back[kind] = restored[kind] & kKnownNodes;
    warped.warped[kind] -= back[kind];
    warped.zero[kind] -= back[kind];
    warped.plus[kind] |= back[kind] & lattice.cuts.signs.inside[kind];
    nonzero[kind] = kKnownNodes - warped.zero[kind];
  }
  if (!back[kCorner].any() && !back[kCentre].any()) return;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    const HaloSet end_plus = seen_from(warped.plus[end], offset);
    const HaloSet opposite_signs =
        (warped.plus[kind] | end_plus) - (warped.plus[kind] & end_plus);
    const HaloSet cut = nonzero[kind] & seen_from(nonzero[end], offset) & opposite_signs;
    clear_ends(cut & (back[kind] | seen_from(back[end], offset)), family, limits, lattice.cuts);
    warped.cut[static_cast<std::size_t>(family)] = cut;
  }
}

}  // namespace tet
