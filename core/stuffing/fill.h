// Filling a finest brick: ids, positions, and the tets of its stencils.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/base/quality.h"
#include "core/lattice/background.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/stuffed_lattice.h"

namespace tet {

/// Ids of the vertices at the nodes [0, 8]^3 and on the edges between them, by halo index; the
/// rest is unspecified.
template <class Index>
struct FinestIds {
  std::array<std::array<Index, kHaloNodes>, kNodeKinds> node;
  std::array<std::array<Index, kHaloNodes>, kEdgeFamilies> cut;
};

/// Vertices of one brick in the order of their ids, from `first` on.
struct OwnedVertices {
  std::array<BrickMask, kNodeKinds> node;
  const std::array<BrickMask, kEdgeFamilies>* cut = nullptr;
  const FanMasks* fans = nullptr;  ///< no other brick has these
  std::uint64_t first = 0;

  std::uint64_t count() const noexcept;
  /// Id of the middle of a tet's surface quad.
  std::uint64_t fan(std::size_t shape, int cell) const noexcept;
};

/// Enters the vertices of the neighbour at offset (bx, by, bz), each 0 or 1.
template <class Index>
void number_vertices(
    const OwnedVertices& vertices, int bx, int by, int bz, FinestIds<Index>& ids) noexcept;

/// A finest brick that is to be filled, as one region sees it.
struct FinestBrick {
  const FinestNodes& nodes;
  const OwnedVertices& own;
  const StuffedLattice* lattice;  ///< null where nothing is zero or cut
  const StuffingRules& rules;
};

/// Writes a brick's tets of one region, four ids each; returns the end. Tets whose nodes moved
/// or were cut are measured by `meter` in units of the spacing; the others are counted in
/// `counts`.
template <class Index>
Index* fill_finest(const FinestBrick& brick,
                   const FinestIds<Index>& ids,
                   Index* tets,
                   QualityMeter& meter,
                   BackgroundCounts& counts) noexcept;

}  // namespace tet
