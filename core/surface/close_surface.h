// From triangles as files have them to a surface that goes around something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/surface/triangle_surface.h"

namespace tet {

/// A surface whose every edge is passed as often one way as the other, so that its winding
/// number is whole everywhere; and what was done to make it so. Units are the surface's.
struct ClosedSurface {
  TriangleSurface surface;               ///< triangles that are wound alike, then caps
  std::size_t cap_begin = 0;             ///< caps are the triangles from here on
  std::uint64_t open_edges = 0;          ///< of one triangle only, before there were caps
  std::uint64_t non_manifold_edges = 0;  ///< of three or more triangles
  std::uint64_t holes = 0;               ///< that caps close
  std::uint64_t doubled_triangles = 0;   ///< left out as others have the same three corners
  std::uint64_t turned_triangles = 0;    ///< wound against their neighbours
  std::uint64_t turned_bodies = 0;       ///< whole pieces that were wound inside out
  double area = 0;                       ///< of the triangles
  double cap_area = 0;                   ///< of the caps
  double widest_hole = 0;                ///< diagonal of the box around it
  double volume = 0;  ///< by divergence; overlaps count as often as they overlap

  /// Pieces that are closed by themselves and enclose something, by triangle; kNoBody for
  /// others.
  static constexpr std::uint32_t kNoBody = 0xFFFFFFFF;
  std::vector<std::uint32_t> body_of;
  std::uint32_t bodies = 0;

  /// Whether the holes are so small that they are faults of the file rather than openings: at
  /// most a hundredth of the surface's area, or none wider than `width`.
  bool nearly_closed(double width) const noexcept;
};

/// Welds vertices, drops triangles that are doubled or without three corners, winds the rest
/// alike and outwards, and caps what is open.
///
/// Vertices of equal coordinates are one. Where edges stay open, those at them are welded, too,
/// when they are no farther apart than `tolerance`, and then up to `gap` where that is what it
/// takes to be nearly closed. A piece that is wound inwards is a cavity within another
/// and is turned round where there is nothing around it.
ClosedSurface close_surface(const TriangleSurface& surface, double tolerance, double gap);

}  // namespace tet
