// Background tets where no surface is: around coarse leaves, and where leaf sizes change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/brick_neighbours.h"
#include "core/lattice/bcc.h"

namespace tet {

class NodeNumbers;
struct OctreeLevel;

/// The four shapes of background tets; see docs/algorithm.md for their dihedral angles.
///   BCC: two centres and an edge of the face between them (60, 90)
///   bisected: the same, cut at the midpoint of that edge (45, 60, 90)
///   quadrisected: a leaf's centre, and an eighth of a face that is refined behind (45, 60, 90)
///   half pyramid: a leaf's centre and half its face towards a larger leaf (45, 60, 90, 120)
/// and on the faces of the domain, where smaller leaves lie beside a leaf's outer face:
///   half pyramid halved, or cut in three: with a midpoint on one, or both, of the half face's
///   own edges
struct BackgroundCounts {
  std::uint64_t bcc = 0, bisected = 0, quadrisected = 0;
  std::uint64_t half_pyramid = 0;
  std::uint64_t halved = 0, in_three = 0;  ///< half pyramids, of two and of three tets

  std::uint64_t total() const noexcept {
    return bcc + bisected + quadrisected + half_pyramid + 2 * halved + 3 * in_three;
  }
};

/// Leaves and refined cells of a brick and its halo, at one level.
struct BackgroundCells {
  HaloSet leaf, refined;
  BrickMask own;  ///< cells of the brick whose tets are meant: its tets are those of its
                  ///< leaves, and those across their upper faces
};

/// The cells of a brick as one region sees them.
BackgroundCells gather_background(const OctreeLevel& level,
                                  BrickCoord brick,
                                  MeshRegion region) noexcept;
BackgroundCells gather_background(const OctreeLevel& level,
                                  const PlacesAround& around,
                                  MeshRegion region) noexcept;

/// Tets of a brick's leaves at a level above 0.
BackgroundCounts count_background(const BackgroundCells& cells) noexcept;

/// Writes them, four ids each, and adds to `counts`; returns the end.
template <class Index>
Index* fill_background(const BackgroundCells& cells,
                       NodeNumbers& numbers,
                       int level,
                       BrickCoord brick,
                       Index* tets,
                       BackgroundCounts& counts) noexcept;

/// A cell's faces are numbered by direction: +x, +y, +z, -x, -y, -z.
inline constexpr int kFaceDirections = 6;
/// The step from a cell to the one across a face.
constexpr LatticeCoord face_step(int direction) noexcept {
  const int sign = direction < 3 ? 1 : -1;
  return {direction % 3 == 0 ? sign : 0, direction % 3 == 1 ? sign : 0,
          direction % 3 == 2 ? sign : 0};
}
constexpr int face_offset(int direction) noexcept {
  const LatticeCoord step = face_step(direction);
  return offset_index(step.x, step.y, step.z);
}

namespace internal {

constexpr LatticeCoord find_face_turn(int direction, int turn) noexcept {
  if (direction < 3) {
    const LatticeCoord at = face_corner(direction, turn);
    return {at.x / 2, at.y / 2, at.z / 2};
  }
  LatticeCoord at = face_corner(direction - 3, 3 - turn);
  at = {at.x / 2, at.y / 2, at.z / 2};
  if (direction == 3) at.x = 0;
  if (direction == 4) at.y = 0;
  if (direction == 5) at.z = 0;
  return at;
}

inline constexpr auto kFaceTurn = [] {
  std::array<std::array<LatticeCoord, 4>, kFaceDirections> corners{};
  for (int d = 0; d < kFaceDirections; ++d) {
    for (int turn = 0; turn < 4; ++turn) {
      corners[static_cast<std::size_t>(d)][static_cast<std::size_t>(turn)] =
          find_face_turn(d, turn);
    }
  }
  return corners;
}();

}  // namespace internal

/// Corner `turn` of a cell's face, offset from the cell: counter-clockwise seen from outside.
constexpr LatticeCoord face_turn(int direction, int turn) noexcept {
  return internal::kFaceTurn[static_cast<std::size_t>(direction)]
                            [static_cast<std::size_t>(turn)];
}

/// A cell of a brick, or of its halo.
struct Cell {
  int x, y, z;
  constexpr Cell(int at_x, int at_y, int at_z) noexcept : x(at_x), y(at_y), z(at_z) {}
  constexpr explicit Cell(int halo_index) noexcept
      : x((halo_index >> 8) - 2), y((halo_index >> 4 & 15) - 2), z((halo_index & 15) - 2) {}
};

/// Writes one tet's ids; returns the end.
template <class Index>
Index* write_tet(Index* out, Index a, Index b, Index c, Index d) noexcept {
  out[0] = a;
  out[1] = b;
  out[2] = c;
  out[3] = d;
  return out + 4;
}

/// The turn at which a face's diagonal starts: towards a larger leaf it joins that leaf's face
/// centre, which is odd along both of the face's axes, to its corner, which is even.
constexpr int diagonal_turn(int direction, Cell cell) noexcept {
  const int axis = direction % 3;
  const auto along_face_odd = [&](LatticeCoord c) {
    return (axis == 0 || ((cell.x + c.x) & 1) != 0) &&
           (axis == 1 || ((cell.y + c.y) & 1) != 0) && (axis == 2 || ((cell.z + c.z) & 1) != 0);
  };
  int start = 0;
  while (!along_face_odd(face_turn(direction, start))) ++start;
  return start;
}

/// The two half pyramids of a cell whose face has no midpoints.
template <class Index, class CornerId>
Index* write_half_pyramids(
    int direction, Cell cell, Index centre, const CornerId& corner_id, Index* tets) noexcept {
  const int start = diagonal_turn(direction, cell);
  std::array<Index, 4> corner;
  for (int turn = 0; turn < 4; ++turn) {
    const LatticeCoord c = face_turn(direction, (start + turn) & 3);
    corner[static_cast<std::size_t>(turn)] =
        corner_id(cell.x + c.x, cell.y + c.y, cell.z + c.z);
  }
  tets = write_tet(tets, centre, corner[0], corner[1], corner[2]);
  return write_tet(tets, centre, corner[0], corner[2], corner[3]);
}

}  // namespace tet
