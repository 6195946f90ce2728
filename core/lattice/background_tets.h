// How background tets are written, whatever stands for their corners: ids when a brick is
// filled, places when its angles are proven.
#pragma once

#include <array>
#include <cstddef>

#include "core/lattice/background.h"

namespace tet {
namespace internal {

/// Offset of the two other cells around edge `turn` of a cell's upper face across `axis`.
constexpr int beside_edge(int axis, int turn) noexcept {
  // Edges run from corner `turn` to the next: they lie low in v, high in u, high in v, low in
  // u.
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  constexpr std::array<int, 4> kSign{-1, 1, 1, -1};
  const int along = turn % 2 == 0 ? v : u;
  return kSign[static_cast<std::size_t>(turn)] * face_offset(along);
}

/// Same-size leaves across the upper face of an axis.
inline HaloSet pairs_across(const BackgroundCells& cells, int axis) noexcept {
  return cells.leaf & seen_from(cells.leaf, face_offset(axis)) & cells.own;
}

/// Where edge `turn` of the face has a midpoint: a cell around it is refined.
inline HaloSet midpoints(const BackgroundCells& cells, int axis, int turn) noexcept {
  const int beside = beside_edge(axis, turn);
  return seen_from(cells.refined, beside) |
         seen_from(cells.refined, beside + face_offset(axis));
}

inline HaloSet faces_to_refined(const BackgroundCells& cells, int direction) noexcept {
  return cells.leaf & seen_from(cells.refined, face_offset(direction)) & cells.own;
}

/// From a cell to the one beside edge `turn` of its face across `direction`.
constexpr int beside_face_edge(int direction, int turn) noexcept {
  const LatticeCoord a = face_turn(direction, turn), b = face_turn(direction, (turn + 1) & 3);
  const auto side = [](int from, int to) { return from == to ? 2 * from - 1 : 0; };
  LatticeCoord step{side(a.x, b.x), side(a.y, b.y), side(a.z, b.z)};
  if (direction % 3 == 0) step.x = 0;
  if (direction % 3 == 1) step.y = 0;
  if (direction % 3 == 2) step.z = 0;
  return offset_index(step.x, step.y, step.z);
}

/// The half pyramids of a face by the midpoints of its four edges. Towards a larger leaf there
/// are none: the leaves beside the face are no smaller, or the tree would not be balanced.
struct HalfPyramids {
  HaloSet cells;
  std::array<HaloSet, 4> middle;  ///< by turn

  int has_middle(int cell, int turn) const noexcept {
    return middle[static_cast<std::size_t>(turn & 3)].test(cell) ? 1 : 0;
  }
};

inline HalfPyramids half_pyramids(const BackgroundCells& cells, int direction) noexcept {
  HalfPyramids found{faces_to_larger(cells, direction), {}};
  if (!found.cells.any()) return found;
  for (int turn = 0; turn < 4; ++turn) {
    found.middle[static_cast<std::size_t>(turn)] =
        found.cells & seen_from(cells.refined, beside_face_edge(direction, turn));
  }
  return found;
}

template <class Index, class Ids>
Index* write_pairs(const BackgroundCells& cells,
                   int axis,
                   Ids& ids,
                   Index* out,
                   BackgroundCounts& counts) noexcept {
  const std::array<HaloSet, 4> middle{midpoints(cells, axis, 0), midpoints(cells, axis, 1),
                                      midpoints(cells, axis, 2), midpoints(cells, axis, 3)};
  for_each_bit(pairs_across(cells, axis), [&](int index) {
    const Cell c(index);
    const Index low = ids.centre(c.x, c.y, c.z);
    const Index high = ids.centre(c.x + (axis == 0), c.y + (axis == 1), c.z + (axis == 2));
    for (int turn = 0; turn < 4; ++turn) {
      const LatticeCoord a = face_turn(axis, turn), b = face_turn(axis, (turn + 1) & 3);
      const Index from = ids.finer_corner(2 * (c.x + a.x), 2 * (c.y + a.y), 2 * (c.z + a.z));
      const Index to = ids.finer_corner(2 * (c.x + b.x), 2 * (c.y + b.y), 2 * (c.z + b.z));
      if (!middle[static_cast<std::size_t>(turn)].test(index)) {
        out = write_tet(out, low, high, from, to);
        ++counts.bcc;
        continue;
      }
      const Index mid =
          ids.finer_corner(2 * c.x + a.x + b.x, 2 * c.y + a.y + b.y, 2 * c.z + a.z + b.z);
      out = write_tet(out, low, high, from, mid);
      out = write_tet(out, low, high, mid, to);
      counts.bisected += 2;
    }
  });
  return out;
}

template <class Index, class Ids>
Index* write_quadrisected(const BackgroundCells& cells,
                          int direction,
                          Ids& ids,
                          Index* out,
                          BackgroundCounts& counts) noexcept {
  for_each_bit(faces_to_refined(cells, direction), [&](int index) {
    counts.quadrisected += 8;
    const Cell c(index);
    const Index centre = ids.centre(c.x, c.y, c.z);
    const LatticeCoord p = face_turn(direction, 0), q = face_turn(direction, 2);
    const Index face_centre =
        ids.finer_corner(2 * c.x + p.x + q.x, 2 * c.y + p.y + q.y, 2 * c.z + p.z + q.z);
    for (int turn = 0; turn < 4; ++turn) {
      const LatticeCoord a = face_turn(direction, turn),
                         b = face_turn(direction, (turn + 1) & 3);
      const Index mid =
          ids.finer_corner(2 * c.x + a.x + b.x, 2 * c.y + a.y + b.y, 2 * c.z + a.z + b.z);
      out = write_tet(out, centre, face_centre,
                      ids.finer_corner(2 * (c.x + a.x), 2 * (c.y + a.y), 2 * (c.z + a.z)), mid);
      out = write_tet(out, centre, face_centre, mid,
                      ids.finer_corner(2 * (c.x + b.x), 2 * (c.y + b.y), 2 * (c.z + b.z)));
    }
  });
  return out;
}

/// The half pyramid over corners `turn`, `turn` + 1 and `turn` + 2 of a face; its first two
/// edges may have midpoints.
template <class Index, class Ids>
Index* write_half_pyramid(const HalfPyramids& found,
                          int direction,
                          int cell,
                          int turn,
                          Ids& ids,
                          Index* out,
                          BackgroundCounts& counts) noexcept {
  const Cell c(cell);
  const auto at = [&](int first, int second) {  // the corner, or the middle of two
    const LatticeCoord p = face_turn(direction, first & 3),
                       q = face_turn(direction, second & 3);
    return ids.finer_corner(2 * c.x + p.x + q.x, 2 * c.y + p.y + q.y, 2 * c.z + p.z + q.z);
  };
  const Index centre = ids.centre(c.x, c.y, c.z);
  const Index a = at(turn, turn), b = at(turn + 1, turn + 1), d = at(turn + 2, turn + 2);
  const bool first = found.has_middle(cell, turn) != 0;
  const bool second = found.has_middle(cell, turn + 1) != 0;
  counts.half_pyramid += !first && !second;
  counts.halved += first != second;
  counts.in_three += first && second;
  if (!first && !second) return write_tet(out, centre, a, b, d);
  if (!second) {
    const Index m = at(turn, turn + 1);
    out = write_tet(out, centre, a, m, d);
    return write_tet(out, centre, m, b, d);
  }
  const Index n = at(turn + 1, turn + 2);
  if (!first) {
    out = write_tet(out, centre, a, b, n);
    return write_tet(out, centre, a, n, d);
  }
  const Index m = at(turn, turn + 1);
  out = write_tet(out, centre, m, b, n);
  out = write_tet(out, centre, a, m, n);
  return write_tet(out, centre, a, n, d);
}

}  // namespace internal

/// Writes the tets of a brick's leaves, four values of `ids` each, and counts them; returns the
/// end.
///
/// ids.finer_corner(x, y, z) stands for a corner of the level below, at twice the cell
/// coordinates; ids.centre(x, y, z) for a cell's centre.
template <class Index, class Ids>
Index* write_background(const BackgroundCells& cells,
                        Ids& ids,
                        Index* tets,
                        BackgroundCounts& counts) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    tets = internal::write_pairs(cells, axis, ids, tets, counts);
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    tets = internal::write_quadrisected(cells, direction, ids, tets, counts);
    const internal::HalfPyramids found = internal::half_pyramids(cells, direction);
    for_each_bit(found.cells, [&](int index) {
      const int start = diagonal_turn(direction, Cell(index));
      for (const int turn : {start, start + 2}) {
        tets = internal::write_half_pyramid(found, direction, index, turn, ids, tets, counts);
      }
    });
  }
  return tets;
}

}  // namespace tet
