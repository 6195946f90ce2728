#include "core/stuffing/warp.h"

#include <cstddef>
#include <numbers>

namespace tet {
namespace {

constexpr HaloSet kNodes = halo_cube(kNodeMin, kNodeMax);

/// Lengths of long and short edges in units of the spacing.
constexpr float kLongLength = 1;
constexpr float kShortLength = static_cast<float>(std::numbers::sqrt3 / 2);

/// Notes a violating cut point of a node, if it is the nearest yet.
void violate(
    WarpedLattice& lattice, NodeKind kind, int node, int direction, float distance) noexcept {
  const auto i = static_cast<std::size_t>(node);
  float& nearest = lattice.distance[kind][i];
  std::uint8_t& chosen = lattice.direction[kind][i];
  if (lattice.warped[kind].test(node) &&
      (distance > nearest || (distance == nearest && direction > chosen))) {
    return;
  }
  lattice.warped[kind].set(node);
  nearest = distance;
  chosen = static_cast<std::uint8_t>(direction);
}

void find_violations(const CutPoints& cuts,
                     int family,
                     const WarpLimits& limits,
                     WarpedLattice& lattice) noexcept {
  const NodeKind kind = family_kind(family);
  const int direction = family_direction(family);
  const int offset = end_offset(kind, direction);
  const float alpha = is_long(direction) ? limits.alpha_long : limits.alpha_short;
  const float length = is_long(direction) ? kLongLength : kShortLength;
  const auto& fraction = cuts.fraction[static_cast<std::size_t>(family)];
  for_each_bit(cuts.cut[static_cast<std::size_t>(family)], [&](int low) {
    const float t = fraction[static_cast<std::size_t>(low)];
    if (t < alpha) {
      violate(lattice, kind, low, direction, t * length);
    } else if (1 - t < alpha) {
      violate(lattice, end_kind(kind, direction), low + offset, opposite(direction),
              (1 - t) * length);
    }
  });
}

}  // namespace

void warp_lattice(const CutPoints& cuts,
                  const WarpLimits& limits,
                  WarpedLattice& lattice) noexcept {
  for (HaloSet& warped : lattice.warped) warped = {};
  for (int family = 0; family < kEdgeFamilies; ++family) {
    find_violations(cuts, family, limits, lattice);
  }
  std::array<HaloSet, kNodeKinds>
      unmoved;  // nodes that keep their sign, and so their cut points
  for (const NodeKind kind : {kCorner, kCentre}) {
    lattice.warped[kind] &= kNodes;
    unmoved[kind] =
        ((cuts.signs.inside[kind] | cuts.signs.outside[kind]) & kNodes) - lattice.warped[kind];
    lattice.zero[kind] = kNodes - unmoved[kind];
    lattice.plus[kind] = cuts.signs.inside[kind] & unmoved[kind];
  }
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const auto f = static_cast<std::size_t>(family);
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    lattice.cut[f] = seen_from(unmoved[end], offset);
    lattice.cut[f] &= unmoved[kind];
    lattice.cut[f] &= cuts.cut[f];
  }
}

bool has_both_sides(const WarpedLattice& lattice) noexcept {
  const HaloSet& corner = lattice.plus[kCorner];
  const HaloSet& centre = lattice.plus[kCentre];
  return (corner.any() || centre.any()) && ((kNodes - corner).any() || (kNodes - centre).any());
}

HaloSet used_zeros(const WarpedLattice& lattice, NodeKind kind) noexcept {
  HaloSet beside_plus;
  for (int direction = 0; direction < kDirections; ++direction) {
    beside_plus |=
        seen_from(lattice.plus[end_kind(kind, direction)], end_offset(kind, direction));
  }
  return lattice.zero[kind] & beside_plus;
}

}  // namespace tet
