// The connected parts of the surface near a brick that is no single sheet there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/heap_bytes.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/topology/surface_regions.h"

namespace tet {

/// A vertex of another brick that belongs to a part of this one's.
struct SurfaceLink {
  std::array<std::int8_t, 3> to_brick{};
  std::uint16_t element = 0;  ///< see SurfaceParts
  std::uint16_t part = 0;
};

/// One bit for each brick around another, by its place (see PlacesAround).
using BricksAround = std::uint32_t;
inline constexpr BricksAround kOwnBrick = 1U << 13;

/// The connected parts of the surface that cross an edge of a brick's own nodes. A part without
/// a vertex of the brick's own may be all that joins those of the bricks around.
///
/// A vertex is an element: 512 * (its node's kind, or 2 + its cut point's edge family) + its
/// node's place in the brick, (x*8 + y)*8 + z.
struct SurfaceParts {
  std::uint16_t count = 0;
  /// Links to later bricks (in 13 directions); a part without an own vertex has links to all
  /// bricks.
  std::vector<SurfaceLink> links;
  /// The part of each element, sorted by element; filled only where there are several parts.
  std::vector<std::array<std::uint16_t, 2>> part_of;
  /// For each part, the other bricks with a node that has an edge to or through it.
  std::vector<BricksAround> beside;

  /// The part of a vertex; std::nullopt when it is not listed, as what another process counted
  /// may lack any. `near` is any number at first, and becomes a place to search from: vertices
  /// that are asked for in ascending order are found soon.
  std::optional<std::uint16_t> part(std::uint16_t element, std::size_t& near) const noexcept;

  /// Memory it takes.
  std::uint64_t bytes() const noexcept {
    return sizeof(*this) + all_heap_bytes(links, part_of, beside);
  }
};

/// Where a vertex is, of a node at an index of a brick's halo: its brick, each coordinate -1, 0
/// or 1, and the node's place there.
struct VertexOwner {
  static constexpr std::array<std::int8_t, 3> kHere{0, 0, 0};

  std::array<std::int8_t, 3> brick;
  std::uint16_t place;

  explicit VertexOwner(int index) noexcept;
  /// `slot` is the node's kind, or 2 + the cut point's edge family.
  std::uint16_t element(std::size_t slot) const noexcept;
};
inline constexpr std::size_t kVertexSlots = kNodeKinds + kEdgeFamilies;

/// Finds the parts of the surface between regions; std::nullopt where there are very many
/// regions, so that the surface has to be walked.
std::optional<SurfaceParts> parts_between_regions(const SurfaceRegions& regions);

}  // namespace tet
