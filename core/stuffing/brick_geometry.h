// What the samples decided of a brick's own vertices, as few numbers as tell it: with the signs
// of a StuffedBrick, the brick can be filled without its samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/stuffed_lattice.h"

namespace tet {

/// Says of a zero node that it lies where the lattice has it.
inline constexpr std::uint8_t kUnmoved = 255;

/// Sizes of a brick's packed geometry: a fraction (float32) for each zero node and each cut
/// point, then a direction (one byte) for each zero node, all in the order of the vertices'
/// ids.
struct GeometrySizes {
  std::size_t zeros, cuts;
  explicit GeometrySizes(const StuffedBrick& brick) noexcept;
  GeometrySizes(std::size_t zero_nodes, std::size_t cut_points) noexcept
      : zeros(zero_nodes), cuts(cut_points) {}
  std::size_t bytes() const noexcept { return (zeros + cuts) * sizeof(float) + zeros; }
};
inline constexpr std::size_t kMaxGeometryBytes =
    std::size_t{kBrickCells} * ((kNodeKinds + kEdgeFamilies) * sizeof(float) + kNodeKinds);

/// Writes the geometry of `brick`, which `lattice` was kept as; returns the end. A moved node's
/// fraction is that of the cut point it moved onto.
std::byte* pack_geometry(const StuffedLattice& lattice,
                         const StuffedBrick& brick,
                         std::byte* out) noexcept;

/// Writes the geometry of brick `o` of the eight around the lattice's own (see reach.h), as far
/// as the latter's tets reach. The rest of `out` stays as it is.
std::byte* pack_geometry_in_reach(const StuffedLattice& lattice,
                                  const StuffedBrick& brick,
                                  std::size_t o,
                                  std::byte* out) noexcept;

/// Reads packed geometry: zero corners first, then zero centres, then cut points by family.
class PackedGeometry {
 public:
  PackedGeometry(const std::byte* bytes, const StuffedBrick& brick) noexcept
      : fractions_(bytes), directions_(bytes) {
    const GeometrySizes sizes(brick);
    zeros_ = sizes.zeros;
    directions_ += sizes.bytes() - sizes.zeros;
  }

  std::size_t zeros() const noexcept { return zeros_; }

  float fraction(std::size_t i) const noexcept {
    float fraction;  // bricks follow each other without gaps, so nothing is aligned
    std::memcpy(&fraction, fractions_ + i * sizeof(float), sizeof(float));
    return fraction;
  }
  /// The direction in which a zero node moved, or kUnmoved.
  std::uint8_t direction(std::size_t i) const noexcept {
    return static_cast<std::uint8_t>(directions_[i]);
  }

 private:
  const std::byte* fractions_;
  const std::byte* directions_;
  std::size_t zeros_;
};

/// The edge that a node moved along, by its family and its lower node.
struct MovedAlong {
  int family, low;
};
MovedAlong moved_along(NodeKind kind, int node, int direction) noexcept;

}  // namespace tet
