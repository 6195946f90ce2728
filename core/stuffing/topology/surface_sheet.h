// Whether the surface near a brick hangs together, told from signs without walking over it.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/topology/surface_regions.h"

namespace tet {

/// The surface in the star of a brick (see kBrickStar). An edge between a `+` node and another
/// is crossed at its cut point, or at its zero end.
struct SurfaceSheet {
  bool any = false;  ///< an edge of one of the brick's own nodes is crossed
  bool one = false;  ///< all crossings hang together: they are on one component of the boundary
  /// Later bricks, at the places 14 .. 26 around this one (see PlacesAround), that see some of
  /// the same crossings.
  std::uint16_t later = 0;
  /// The `+` nodes hang together and the `-` nodes do, but some zeros have no `-` beside them,
  /// so that it takes a closer look whether there is one sheet.
  bool has_plain_sides = false;
};

/// A surface that cuts a ball in pieces has as many as there are regions on both of its sides,
/// less one; so there is one where the `+` nodes are connected, and the others are. Filling a
/// set of nodes is cheaper than following a surface. Edges between zeros do not count as
/// connections: they may lie within the inside, with no boundary along them. So it may fail to
/// be seen that there is one, but never the reverse.
SurfaceSheet surface_sheet(const SignedNodes& signs) noexcept;

/// The sheet between regions that have one.
SurfaceSheet sheet_between(const SurfaceRegions& regions) noexcept;

}  // namespace tet
