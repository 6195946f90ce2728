// The connected parts of the surface near a brick, walked tet by tet: for the few bricks where
// signs alone do not tell that there is one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/warp.h"

namespace tet {

/// A vertex of a later brick (in one of 13 directions) that belongs to a part of this one's.
struct SurfaceLink {
  std::array<std::int8_t, 3> to_brick{};
  std::uint16_t element = 0;  ///< see SurfaceParts
  std::uint16_t part = 0;
};

/// One bit for each brick around another, by its place (see PlacesAround).
using BricksAround = std::uint32_t;

/// The connected parts of the surface that have a vertex in a brick.
///
/// A vertex is an element: 512 * (its node's kind, or 2 + its cut point's edge family) + its
/// node's place in the brick, (x*8 + y)*8 + z.
struct SurfaceParts {
  std::uint16_t count = 0;
  std::vector<SurfaceLink> links;
  /// Where there are several parts: that of each element, sorted by element.
  std::vector<std::array<std::uint16_t, 2>> part_of;
  /// Of each part, other bricks with a node that has an edge to or through it.
  std::vector<BricksAround> beside;

  std::uint16_t part(std::uint16_t element) const noexcept;
};

/// Scratch memory of `find_surface_parts`, reused from brick to brick.
class SurfaceWorkspace;

SurfaceParts find_surface_parts(const WarpedLattice& lattice, SurfaceWorkspace& workspace);

class SurfaceWorkspace {
 public:
  void clear() noexcept;

  /// Unites the parts of two vertices, each at 4096 * slot + halo index.
  void unite(std::uint16_t a, std::uint16_t b) noexcept;
  std::uint16_t find(std::uint16_t vertex) noexcept;
  const HaloSet& touched(std::size_t slot) const noexcept { return touched_[slot]; }

  /// Bricks with a node that has an edge to, or through, what has this vertex.
  struct Beside {
    std::uint16_t vertex;
    BricksAround bricks;
  };
  std::vector<Beside>& beside() noexcept { return beside_; }
  std::vector<SurfaceLink>& links() noexcept { return links_; }

  static constexpr std::size_t kSlots = kNodeKinds + kEdgeFamilies;

 private:
  void touch(std::uint16_t vertex) noexcept;

  std::array<HaloSet, kSlots> touched_;
  std::array<std::uint16_t, kSlots * kHaloNodes> parent_;
  std::vector<Beside> beside_;
  std::vector<SurfaceLink> links_;
};

}  // namespace tet
