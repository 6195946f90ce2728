// The parts of the surface near a brick, walked tet by tet: where there are too many regions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/stuffing/topology/surface_parts.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Scratch memory of `walk_surface`, reused from brick to brick.
class SurfaceWorkspace;

SurfaceParts walk_surface(const WarpedLattice& lattice, SurfaceWorkspace& workspace);

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

  static constexpr std::size_t kSlots = kVertexSlots;

 private:
  void touch(std::uint16_t vertex) noexcept;

  std::array<HaloSet, kSlots> touched_;
  std::array<std::uint16_t, kSlots * kHaloNodes> parent_;
  std::vector<Beside> beside_;
  std::vector<SurfaceLink> links_;
};

}  // namespace tet
