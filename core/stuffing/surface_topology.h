// The topology of the surface, counted from signs alone while a brick is surveyed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/lattice/bcc.h"
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

/// A vertex of a later brick (in one of 13 directions) that belongs to a part of this one's.
struct SurfaceLink {
  std::array<std::int8_t, 3> to_brick{};
  std::uint16_t element = 0;  ///< see SurfaceParts
  std::uint16_t part = 0;
};

/// The connected parts of the surface that have a vertex in a brick.
///
/// A vertex is an element: 512 * (its node's kind, or 2 + its cut point's edge family) + its
/// node's place in the brick, (x*8 + y)*8 + z.
struct SurfaceParts {
  std::uint16_t count = 0;
  std::vector<SurfaceLink> links;
  /// Where there are several parts: that of each element, sorted by element.
  std::vector<std::array<std::uint16_t, 2>> part_of;

  std::uint16_t part(std::uint16_t element) const noexcept;
};

/// Scratch memory of `survey_surface`, reused from brick to brick.
class SurfaceWorkspace;

struct SurveyedSurface {
  SurfaceCounts counts;
  SurfaceParts parts;
};

/// Counts a brick's own vertices, edges and triangles, and finds its parts.
SurveyedSurface survey_surface(const WarpedLattice& lattice, SurfaceWorkspace& workspace);

/// Nodes of the brick where the boundary of the inside is no manifold, ends of edges that are
/// none included. `plus` and `zero` are valid for nodes in [-1, 8]^3.
std::array<BrickMask, kNodeKinds> non_manifold_nodes(
    const std::array<HaloSet, kNodeKinds>& plus,
    const std::array<HaloSet, kNodeKinds>& zero) noexcept;

class SurfaceWorkspace {
 public:
  void clear() noexcept { touched_ = {}; }

  /// Unites the parts of two vertices, each at 4096 * slot + halo index.
  void unite(std::uint16_t a, std::uint16_t b) noexcept;
  std::uint16_t find(std::uint16_t vertex) noexcept;
  const HaloSet& touched(std::size_t slot) const noexcept { return touched_[slot]; }

  std::vector<SurfaceLink>& links() noexcept { return links_; }

  static constexpr std::size_t kSlots = kNodeKinds + kEdgeFamilies;

 private:
  void touch(std::uint16_t vertex) noexcept;

  std::array<HaloSet, kSlots> touched_;
  std::array<std::uint16_t, kSlots * kHaloNodes> parent_;
  std::vector<SurfaceLink> links_;
};

}  // namespace tet
