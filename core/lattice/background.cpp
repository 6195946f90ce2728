#include "core/lattice/background.h"

#include <memory>

namespace tet {
namespace {

constexpr HaloSet kOwnCells = halo_cube(0, 7);

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
HaloSet pairs_across(const BackgroundCells& cells, int axis) noexcept {
  return cells.leaf & seen_from(cells.leaf, face_offset(axis)) & kOwnCells;
}

/// Where edge `turn` of the face has a midpoint: a cell around it is refined.
HaloSet midpoints(const BackgroundCells& cells, int axis, int turn) noexcept {
  const int beside = beside_edge(axis, turn);
  return seen_from(cells.refined, beside) |
         seen_from(cells.refined, beside + face_offset(axis));
}

HaloSet faces_to_refined(const BackgroundCells& cells, int direction) noexcept {
  return cells.leaf & seen_from(cells.refined, face_offset(direction)) & kOwnCells;
}

/// Ids around one brick, looked up once each: corners of the level below, 17 along each edge.
template <class Index>
class BrickIds {
 public:
  BrickIds(const NodeNumbers& numbers, int level, BrickCoord brick)
      : numbers_(numbers), level_(level), brick_(brick) {
    ids_.fill(kUnknown);
  }

  /// Corner at twice the cell coordinates, so that midpoints have whole ones.
  Index finer_corner(int x, int y, int z) noexcept {
    Index& id = ids_[static_cast<std::size_t>((x * 17 + y) * 17 + z)];
    if (id == kUnknown) {
      id = static_cast<Index>(numbers_.finer_corner(level_, brick_, x, y, z));
    }
    return id;
  }
  Index centre(int x, int y, int z) noexcept {
    return static_cast<Index>(numbers_.centre(level_, brick_, x, y, z));
  }

 private:
  static constexpr Index kUnknown = ~Index{0};
  const NodeNumbers& numbers_;
  int level_;
  BrickCoord brick_;
  std::array<Index, std::size_t{17} * 17 * 17> ids_;
};

template <class Index>
Index* write_pairs(const BackgroundCells& cells,
                   int axis,
                   BrickIds<Index>& ids,
                   Index* out) noexcept {
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
        continue;
      }
      const Index mid =
          ids.finer_corner(2 * c.x + a.x + b.x, 2 * c.y + a.y + b.y, 2 * c.z + a.z + b.z);
      out = write_tet(out, low, high, from, mid);
      out = write_tet(out, low, high, mid, to);
    }
  });
  return out;
}

template <class Index>
Index* write_quadrisected(const BackgroundCells& cells,
                          int direction,
                          BrickIds<Index>& ids,
                          Index* out) noexcept {
  for_each_bit(faces_to_refined(cells, direction), [&](int index) {
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

}  // namespace

BackgroundCells gather_background(const OctreeLevel& level, BrickCoord brick) noexcept {
  return {gather_halo(level, level.leaf, brick), gather_halo(level, level.refined, brick)};
}

HaloSet faces_to_larger(const BackgroundCells& cells, int direction) noexcept {
  return (cells.leaf & kOwnCells) -
         seen_from(cells.leaf | cells.refined, face_offset(direction));
}

BackgroundCounts count_background(const BackgroundCells& cells) noexcept {
  BackgroundCounts counts;
  for (int axis = 0; axis < 3; ++axis) {
    const HaloSet pairs = pairs_across(cells, axis);
    for (int turn = 0; turn < 4; ++turn) {
      const std::uint64_t halved = (pairs & midpoints(cells, axis, turn)).count();
      counts.bcc += pairs.count() - halved;
      counts.bisected += 2 * halved;
    }
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    counts.quadrisected += 8 * std::uint64_t{faces_to_refined(cells, direction).count()};
    counts.half_pyramid += 2 * std::uint64_t{faces_to_larger(cells, direction).count()};
  }
  return counts;
}

template <class Index>
Index* fill_background(const BackgroundCells& cells,
                       const NodeNumbers& numbers,
                       int level,
                       BrickCoord brick,
                       Index* tets) noexcept {
  BrickIds<Index> ids(numbers, level, brick);
  for (int axis = 0; axis < 3; ++axis) tets = write_pairs(cells, axis, ids, tets);
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    tets = write_quadrisected(cells, direction, ids, tets);
    for_each_bit(faces_to_larger(cells, direction), [&](int index) {
      const Cell c(index);
      const auto corner = [&](int x, int y, int z) {
        return ids.finer_corner(2 * x, 2 * y, 2 * z);
      };
      tets = write_half_pyramids(direction, c, ids.centre(c.x, c.y, c.z), corner, tets);
    });
  }
  return tets;
}

template std::uint32_t* fill_background(
    const BackgroundCells&, const NodeNumbers&, int, BrickCoord, std::uint32_t*) noexcept;
template std::uint64_t* fill_background(
    const BackgroundCells&, const NodeNumbers&, int, BrickCoord, std::uint64_t*) noexcept;

}  // namespace tet
