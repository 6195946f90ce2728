// Whether the surface near a brick hangs together, told from signs without walking over it.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"

namespace tet {

/// The surface among the nodes [-1, 8]^3 of a brick, as far as `+` and other nodes tell: each
/// edge between the two is crossed once.
struct SurfaceSheet {
  bool any = false;  ///< it crosses an edge of one of the brick's own nodes
  bool one = false;  ///< all edges that it crosses hang together
  /// Later bricks, at the places 14 .. 26 around this one (see PlacesAround), that see some of
  /// the same edges crossed.
  std::uint16_t later = 0;
};

/// `plus` has nodes in [-1, 8]^3 only.
///
/// A closed surface cuts a ball into one region more than it has pieces, so there is one piece
/// exactly where both the `+` nodes and the others are connected: and filling a set of nodes is
/// cheaper than following a surface. Connections along short edges alone are looked at, so it
/// may fail to be seen that there is but one.
SurfaceSheet surface_sheet(const std::array<HaloSet, kNodeKinds>& plus) noexcept;

}  // namespace tet
