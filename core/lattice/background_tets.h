// How background tets are written, whatever stands for their corners: ids when a brick is
// filled, places when its angles are proven.
#pragma once

#include <array>
#include <cstddef>

#include "core/lattice/background.h"

namespace tet {
namespace internal {

/// The step to the other two cells around edge `turn` of a cell's upper face across `axis`:
/// from the cell, and from the one across that face.
constexpr LatticeCoord beside_edge(int axis, int turn) noexcept {
  // Edges run from corner `turn` to the next: they lie low in v, high in u, high in v, low in
  // u.
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int along = turn % 2 == 0 ? v : u;
  const bool is_up = turn == 1 || turn == 2;
  return face_step(is_up ? along : along + 3);
}

/// The leaves that have a leaf of their size across the upper face of an axis.
inline BrickMask pairs_across(const BackgroundCells& cells, int axis) noexcept {
  return brick_part(cells.leaf) & brick_part(cells.leaf, face_step(axis)) & cells.own;
}

/// The cells where edge `turn` of the face has a midpoint, as a cell around the edge is
/// refined.
inline BrickMask midpoints(const BackgroundCells& cells, int axis, int turn) noexcept {
  const LatticeCoord beside = beside_edge(axis, turn);
  return brick_part(cells.refined, beside) |
         brick_part(cells.refined, beside + face_step(axis));
}

inline BrickMask faces_to_refined(const BackgroundCells& cells, int direction) noexcept {
  return brick_part(cells.leaf) & brick_part(cells.refined, face_step(direction)) & cells.own;
}

/// Own leaves whose face touches a larger leaf, or is a face of the domain: neither leaf nor
/// refined at this level.
inline BrickMask faces_to_larger(const BackgroundCells& cells, int direction) noexcept {
  const LatticeCoord across = face_step(direction);
  return brick_part(cells.leaf) & cells.own &
         ~(brick_part(cells.leaf, across) | brick_part(cells.refined, across));
}

/// From a cell to the one beside edge `turn` of its face across `direction`.
constexpr LatticeCoord beside_face_edge(int direction, int turn) noexcept {
  const LatticeCoord a = face_turn(direction, turn), b = face_turn(direction, (turn + 1) & 3);
  const auto side = [](int from, int to) { return from == to ? 2 * from - 1 : 0; };
  LatticeCoord step{side(a.x, b.x), side(a.y, b.y), side(a.z, b.z)};
  if (direction % 3 == 0) step.x = 0;
  if (direction % 3 == 1) step.y = 0;
  if (direction % 3 == 2) step.z = 0;
  return step;
}

/// The half pyramids of a face by the midpoints of its four edges. Towards a larger leaf there
/// are none: the leaves beside the face are no smaller, or the tree would not be balanced.
struct HalfPyramids {
  BrickMask cells;
  std::array<BrickMask, 4> middle;  ///< by turn

  int has_middle(Cell cell, int turn) const noexcept {
    return middle[static_cast<std::size_t>(turn & 3)].test(cell.x, cell.y, cell.z) ? 1 : 0;
  }
};

inline HalfPyramids half_pyramids(const BackgroundCells& cells, int direction) noexcept {
  HalfPyramids found{faces_to_larger(cells, direction), {}};
  if (!found.cells.any()) return found;
  for (int turn = 0; turn < 4; ++turn) {
    found.middle[static_cast<std::size_t>(turn)] =
        found.cells & brick_part(cells.refined, beside_face_edge(direction, turn));
  }
  return found;
}

/// The axis is known when it is compiled, and with it every step to a corner.
template <int kAxis, class Index, class Ids>
Index* write_pairs(const BackgroundCells& cells,
                   Ids& ids,
                   Index* out,
                   BackgroundCounts& counts) noexcept {
  const std::array<BrickMask, 4> middle{midpoints(cells, kAxis, 0), midpoints(cells, kAxis, 1),
                                        midpoints(cells, kAxis, 2), midpoints(cells, kAxis, 3)};
  const BrickMask any_middle = (middle[0] | middle[1]) | (middle[2] | middle[3]);
  for_each_bit(pairs_across(cells, kAxis), [&](int x, int y, int z) {
    const Index low = ids.centre(x, y, z);
    const Index high = ids.centre(x + (kAxis == 0), y + (kAxis == 1), z + (kAxis == 2));
    const auto corner_at = [&](int turn) {
      const LatticeCoord a = face_turn(kAxis, turn);
      return ids.finer_corner(2 * (x + a.x), 2 * (y + a.y), 2 * (z + a.z));
    };
    const std::array<Index, 4> corner{corner_at(0), corner_at(1), corner_at(2), corner_at(3)};
    if (!any_middle.test(x, y, z)) {
      out = write_tet(out, low, high, corner[0], corner[1]);
      out = write_tet(out, low, high, corner[1], corner[2]);
      out = write_tet(out, low, high, corner[2], corner[3]);
      out = write_tet(out, low, high, corner[3], corner[0]);
      counts.bcc += 4;
      return;
    }
    for (int turn = 0; turn < 4; ++turn) {
      const auto t = static_cast<std::size_t>(turn);
      const Index from = corner[t], to = corner[(t + 1) & 3];
      if (!middle[t].test(x, y, z)) {
        out = write_tet(out, low, high, from, to);
        ++counts.bcc;
        continue;
      }
      const LatticeCoord a = face_turn(kAxis, turn), b = face_turn(kAxis, (turn + 1) & 3);
      const Index mid =
          ids.finer_corner(2 * x + a.x + b.x, 2 * y + a.y + b.y, 2 * z + a.z + b.z);
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
  for_each_bit(faces_to_refined(cells, direction), [&](int x, int y, int z) {
    counts.quadrisected += 8;
    const Index centre = ids.centre(x, y, z);
    const auto middle_of = [&](int first, int second) {
      const LatticeCoord a = face_turn(direction, first), b = face_turn(direction, second);
      return ids.finer_corner(2 * x + a.x + b.x, 2 * y + a.y + b.y, 2 * z + a.z + b.z);
    };
    const Index face_centre = middle_of(0, 2);
    Index from = middle_of(0, 0);
    for (int turn = 0; turn < 4; ++turn) {
      const int next = (turn + 1) & 3;
      const Index mid = middle_of(turn, next), to = middle_of(next, next);
      out = write_tet(out, centre, face_centre, from, mid);
      out = write_tet(out, centre, face_centre, mid, to);
      from = to;
    }
  });
  return out;
}

/// The half pyramid over corners `turn`, `turn` + 1 and `turn` + 2 of a cell's face; its first
/// two edges may have midpoints.
struct HalfPyramid {
  int direction;  ///< of the face
  Cell cell;
  int turn;
};

template <class Index, class Ids>
Index* write_half_pyramid(const HalfPyramids& found,
                          const HalfPyramid& half,
                          Ids& ids,
                          Index* out,
                          BackgroundCounts& counts) noexcept {
  const auto [direction, cell, turn] = half;
  // The corner, or the middle of two.
  const auto at = [&ids, direction = direction, c = cell](int first, int second) {
    const LatticeCoord p = face_turn(direction, first & 3),
                       q = face_turn(direction, second & 3);
    return ids.finer_corner(2 * c.x + p.x + q.x, 2 * c.y + p.y + q.y, 2 * c.z + p.z + q.z);
  };
  const Index centre = ids.centre(cell.x, cell.y, cell.z);
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
  tets = internal::write_pairs<0>(cells, ids, tets, counts);
  tets = internal::write_pairs<1>(cells, ids, tets, counts);
  tets = internal::write_pairs<2>(cells, ids, tets, counts);
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    tets = internal::write_quadrisected(cells, direction, ids, tets, counts);
    const internal::HalfPyramids found = internal::half_pyramids(cells, direction);
    for_each_bit(found.cells, [&](int x, int y, int z) {
      const Cell cell{x, y, z};
      const int start = diagonal_turn(direction, cell);
      for (const int turn : {start, start + 2}) {
        tets = internal::write_half_pyramid(found, {direction, cell, turn}, ids, tets, counts);
      }
    });
  }
  return tets;
}

}  // namespace tet
