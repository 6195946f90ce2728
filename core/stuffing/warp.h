// Moving nodes onto cut points that lie too close to them, all at once.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_points.h"
#include "core/stuffing/stuffing_rules.h"

namespace tet {

/// Each node's nearest violating cut point, while they are looked for. Numbers of a brick are
/// below those of all bricks before it, so that none is ever cleared.
class NearestCuts {
 public:
  /// What the numbers of the next brick have in common, in their highest bits.
  std::uint64_t begin_brick() noexcept;

  std::uint64_t* data() noexcept { return number_.front().data(); }

 private:
  std::uint32_t bricks_left_ = 0;  ///< 0: all are to be cleared first
  alignas(64) std::array<std::array<std::uint64_t, kHaloNodes>, kNodeKinds> number_;
};

/// The lattice after the warp; sets are valid for nodes in [kNodeMin, kNodeMax]^3.
///
/// A node is `+` (inside), `0` (on the surface: warped, or exactly zero) or else `-`.
struct WarpedLattice {
  std::array<HaloSet, kNodeKinds> plus;
  std::array<HaloSet, kNodeKinds> zero;
  std::array<HaloSet, kNodeKinds> warped;  ///< zero nodes that moved
  /// Where `warped`: the edge direction, 0..13, whose cut point the node moved onto.
  alignas(64) std::array<std::array<std::uint8_t, kHaloNodes>, kNodeKinds> direction;
  /// Cut points that remain: both ends known and neither of them zero.
  std::array<HaloSet, kEdgeFamilies> cut;

  NearestCuts nearest;  ///< scratch memory of the warp
};

/// Decides every warp from the original samples, so that no order exists: a violated node goes
/// to its nearest violating cut point (ties: lowest direction) and becomes zero. Source:
/// Labelle & Shewchuk 2007, section 3, made simultaneous.
void warp_lattice(const CutPoints& cuts,
                  const WarpLimits& limits,
                  WarpedLattice& lattice) noexcept;

/// True when some of the nodes are `+` and some are not.
bool has_both_sides(const WarpedLattice& lattice) noexcept;

}  // namespace tet
