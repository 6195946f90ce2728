// The topology of the surface, counted from signs alone while a brick is surveyed.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/topology/surface_sheet.h"
#include "core/stuffing/warp.h"

namespace tet {

/// What bricks add to the boundary of the inside. The surface is closed, and an edge of it that
/// is no manifold has pairs of triangles beyond the first, so there are
/// 3/2 * triangles - extra_pairs edges.
struct SurfaceCounts {
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t non_manifold_edges = 0, extra_pairs = 0, non_manifold_vertices = 0;

  void add(const SurfaceCounts& more) noexcept;
  /// Some of the quads have a vertex in their middle, and so four triangles.
  void add_fans(std::uint64_t fans) noexcept;
  std::int64_t euler_characteristic() const noexcept;
};

/// What a survey finds of the surface in a brick.
struct SurveyedSurface {
  SurfaceCounts counts;
  SurfaceSheet sheet;
};

/// Counts a brick's own vertices, edges and triangles, and looks whether they hang together.
/// `kept` is what `keep_brick` keeps of the lattice.
SurveyedSurface survey_surface(const WarpedLattice& lattice, const StuffedBrick& kept) noexcept;

/// Nodes of the brick where the boundary of the inside is no manifold, ends of edges that are
/// none included. `plus` and `zero` are valid for nodes in [-1, 8]^3.
NodeMasks non_manifold_nodes(const std::array<HaloSet, kNodeKinds>& plus,
                             const std::array<HaloSet, kNodeKinds>& zero) noexcept;

}  // namespace tet
