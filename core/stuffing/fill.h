// Filling a finest brick: ids, positions, and the tets of its stencils.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/base/quality.h"
#include "core/lattice/background.h"
#include "core/stuffing/cut_points.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Geometry of a brick near the surface: cut points and warps, found anew when it is filled.
struct StuffedLattice {
  CutPoints cuts;
  WarpedLattice warped;

  /// Where a node or a cut point lies, in units of the spacing from the brick's lowest corner.
  WorldPoint place_of_node(NodeKind kind, int index) const noexcept;
  WorldPoint place_of_cut(int family, int index) const noexcept;
};

/// Where a node of an unmoved lattice lies.
WorldPoint lattice_place(NodeKind kind, int index) noexcept;

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
  std::uint64_t first = 0;
};

/// Enters the vertices of the neighbour at offset (bx, by, bz), each 0 or 1.
template <class Index>
void number_vertices(
    const OwnedVertices& vertices, int bx, int by, int bz, FinestIds<Index>& ids) noexcept;

/// Writes a brick's tets, four ids each; returns the end. `lattice` is null where nothing is
/// zero or cut. Tets whose nodes moved or were cut are measured by `meter` in units of the
/// spacing; the others are counted in `counts`.
template <class Index>
Index* fill_finest(const FinestNodes& nodes,
                   const FinestIds<Index>& ids,
                   const StuffedLattice* lattice,
                   Index* tets,
                   QualityMeter& meter,
                   BackgroundCounts& counts) noexcept;

}  // namespace tet
