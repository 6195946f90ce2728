// What the samples decided of a brick's own vertices, as few numbers as tell it: with the signs
// of a StuffedBrick, the brick can be filled without its samples.
#pragma once

#include <cstddef>
#include <cstdint>

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
  std::size_t bytes() const noexcept { return (zeros + cuts) * sizeof(float) + zeros; }
};

/// Writes the geometry of `brick`, which `lattice` was kept as; returns the end. A moved node's
/// fraction is that of the cut point it moved onto.
std::byte* pack_geometry(const StuffedLattice& lattice,
                         const StuffedBrick& brick,
                         std::byte* out) noexcept;

/// Enters the geometry of the neighbour at offset (bx, by, bz), each 0 or 1, where the nodes
/// [0, 8]^3 and the edges between them show it; the rest of `lattice` stays as it is. Source:
/// what `pack_geometry` wrote for `brick`.
void unpack_geometry(const StuffedBrick& brick,
                     const std::byte* geometry,
                     int bx,
                     int by,
                     int bz,
                     StuffedLattice& lattice) noexcept;

}  // namespace tet
