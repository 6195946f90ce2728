// Where a mesh of both sides ends: which of a brick's cells lie at faces of the domain, and
// which of their tets have a face there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/lattice/background.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/local_faces.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

/// A box of finest cells, the upper ends excluded; empty at first.
struct CellBox {
  std::array<std::int64_t, 3> min{INT64_MAX, INT64_MAX, INT64_MAX};
  std::array<std::int64_t, 3> max{INT64_MIN, INT64_MIN, INT64_MIN};

  /// Grows to hold a brick's leaves, too.
  void add(BrickCoord brick, int level, const BrickMask& leaves) noexcept;
};

/// Cells of a brick with a face in each of the domain's faces, by direction.
using OuterCells = std::array<BrickMask, kFaceDirections>;

OuterCells outer_cells(const CellBox& domain, BrickCoord brick, int level) noexcept;
bool any(const OuterCells& outer) noexcept;

/// The place among a mesh's labels (see face_labels_of) of the domain's face in a direction.
constexpr std::uint8_t label_of_direction(int direction) noexcept {
  return static_cast<std::uint8_t>(1 + 2 * (direction % 3) + (direction < 3 ? 1 : 0));
}

/// Signs of nodes near a brick, as the inside sees them. Coordinates are those of the brick's
/// cells, or of the bricks' around it.
class NodesAround {
 public:
  explicit NodesAround(const BrickSurroundings& around) noexcept : around_(&around) {}

  bool is_plus(NodeKind kind, int x, int y, int z) const noexcept {
    const StuffedBrick* brick = brick_at(x, y, z);
    return brick != nullptr && brick->plus[kind].test(x & 7, y & 7, z & 7);
  }
  bool is_minus(NodeKind kind, int x, int y, int z) const noexcept {
    const StuffedBrick* brick = brick_at(x, y, z);
    return brick == nullptr || !(brick->plus[kind].test(x & 7, y & 7, z & 7) ||
                                 brick->zero[kind].test(x & 7, y & 7, z & 7));
  }

 private:
  const StuffedBrick* brick_at(int x, int y, int z) const noexcept {
    return (*around_)[static_cast<std::size_t>(9 * ((x >> 3) + 1) + 3 * ((y >> 3) + 1) +
                                               (z >> 3) + 1)];
  }

  const BrickSurroundings* around_;
};

/// The faces that tets of a finest brick have at the domain's end. Half pyramids on a face of
/// the domain with a cut or moved node are left out: the faces behind such a dent are at the
/// end, too, and are labelled as the face of the domain that is dented.
class DomainFaces {
 public:
  DomainFaces(const OuterCells& outer, const BrickSurroundings& around) noexcept
      : outer_(&outer), nodes_(around) {}

  const OuterCells& outer() const noexcept { return *outer_; }

  /// Corners of a tet shape in a cell that are opposite a face behind a dent, one bit each.
  unsigned behind_dents(std::size_t shape, int x, int y, int z) const noexcept;
  /// The cells where there may be any; they all lie towards direction_of(shape).
  BrickMask near_dents(const CellNodes& nodes, std::size_t shape) const noexcept;
  static int direction_of(std::size_t shape) noexcept;

  /// Faces of the tets that the brick's cells carry in the region that sees `nodes`.
  std::uint64_t count(const CellNodes& nodes) const noexcept;

  /// Notes those of half pyramids across `direction`, which are written cell by cell from
  /// number `first` on.
  void add_half_pyramids(const BrickMask& cells,
                         int direction,
                         std::size_t first,
                         LocalFaces& faces) const noexcept;

 private:
  bool is_dented(int x, int y, int z, int direction) const noexcept;
  std::uint64_t count_behind_dents(const CellNodes& nodes, std::size_t shape) const noexcept;
  template <class Visit>
  void for_each_of_half_pyramids(const BrickMask& cells,
                                 int direction,
                                 const Visit& visit) const noexcept;

  const OuterCells* outer_;
  NodesAround nodes_;
};

/// Triangles that a region's part of a cut tet has on a face of the lattice, where so many of
/// its nodes are the region's and the other's.
constexpr std::size_t triangles_on_face(std::size_t plus, std::size_t minus) noexcept {
  if (plus == 0) return 0;
  return plus == 2 && minus == 1 ? 2 : 1;
}

/// The stencil vertices on the face opposite each node of a lattice tet, one bit each.
inline constexpr auto kVerticesOnFace = [] {
  std::array<unsigned, 4> on_face{};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < 4; ++i) on_face[k] |= i != k ? 1U << i : 0U;
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      const bool touches = kTetEdge[e][0] == k || kTetEdge[e][1] == k;
      if (!touches) on_face[k] |= 1U << cut_on_edge(e);
    }
  }
  return on_face;
}();

/// Faces that a coarser brick's tets have in the domain's, in the order in which the tets are
/// written.
std::uint64_t count_background_faces(const BackgroundCells& cells,
                                     const OuterCells& outer) noexcept;
/// Notes them; the brick's first tet of the region is number `first`.
void add_background_faces(const BackgroundCells& cells,
                          const OuterCells& outer,
                          std::size_t first,
                          LocalFaces& faces) noexcept;

}  // namespace tet
