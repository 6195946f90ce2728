// What a mesh says of walls too thin for its lattice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// Where the lattice cannot resolve the walls of a surface: there the mesh may have holes,
/// crumbs or bridges that the surface has not. Lengths and boxes in world units.
struct ThinWalls {
  /// Spots that belong together: their bricks touch.
  struct Region {
    WorldBox box;  ///< around its spots
    std::uint64_t inside = 0, outside = 0;
  };
  static constexpr std::size_t kMaxRegions = 16;

  std::uint64_t inside = 0;   ///< spots in walls of inside
  std::uint64_t outside = 0;  ///< spots in walls of outside: gaps
  std::uint64_t region_count = 0;
  std::vector<Region> regions;  ///< the kMaxRegions with the most spots, most first
  /// A quarter of the spots are thinner than this. 0 without spots, like the next.
  double thickness = 0;
  /// A grid sampled this finely and meshed at this spacing would resolve them. 0 where no
  /// spacing is known to: at sharp edges, and where surfaces touch, walls and gaps come down to
  /// nothing.
  double suggested_spacing = 0;

  bool any() const noexcept { return inside + outside > 0; }
};

}  // namespace tet
