// The triangles of the surface that bound a finest brick's tets inside: counted from signs, and
// noted while the tets are made.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/count_tets.h"
#include "core/stuffing/domain_faces.h"
#include "core/stuffing/faces_around.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

/// Tets `+000` of one shape, and which of their nodes is the `+`.
struct TetsOnSurface {
  BrickMask tets;
  BrickMask plus_is_odd, plus_is_high;  ///< the `+` node's number as two bits

  /// `bit` is the cell's in slice x.
  std::size_t plus_node(std::size_t x, int bit) const noexcept {
    return (plus_is_odd.slice[x] >> bit & 1) + 2 * (plus_is_high.slice[x] >> bit & 1);
  }
};
using SurfaceOfBrick = std::array<TetsOnSurface, kTetShapes>;

/// Finds those whose three zeros are a triangle of the surface: the tet behind them is not
/// inside, too, and they do not lie at the domain's end. `inside` has the nodes as the inside
/// sees them, `three_zeros` its tets `+000`.
void find_on_surface(const ThreeZeros& three_zeros,
                     const CellNodes& inside,
                     const FacesAround& around,
                     SurfaceOfBrick& surface) noexcept;

/// The brick's tets inside, as count_finest counts them, and triangles of the surface that
/// bound them. `fans` is null where there are none.
FinestCounts count_finest_with_faces(const CellNodes& inside,
                                     const FacesAround& around,
                                     const FanMasks* fans) noexcept;

/// The corner of a stencil's tet that is opposite a triangle of the surface, or 4: no stencil's
/// tet has more than one. `zeros` has a bit for each node of the lattice tet that is zero.
constexpr std::size_t opposite_surface(const std::array<StencilVertex, 4>& tet,
                                       unsigned zeros) noexcept {
  const unsigned off_surface = ~zeros & 0xf;  // the nodes that are; all else is on it
  constexpr std::array<std::uint8_t, 16> kOpposite{4, 0, 1, 4, 2, 4, 4, 4,
                                                   3, 4, 4, 4, 4, 4, 4, 4};  // by bits
  unsigned off = 0;
  for (unsigned i = 0; i < 4; ++i) off |= (off_surface >> tet[i] & 1) << i;
  return kOpposite[off];
}

}  // namespace tet
