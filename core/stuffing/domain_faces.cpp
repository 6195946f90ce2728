#include "core/stuffing/domain_faces.h"

#include <algorithm>

#include "core/lattice/background_tets.h"

namespace tet {
namespace {

/// Which way a step to a cell across a face leads.
constexpr int direction_of_step(LatticeCoord step) noexcept {
  int direction = 0;
  while (face_step(direction) != step) ++direction;
  return direction;
}

/// Around a cell's face the corners of the edges that its neighbours share, by turn.
struct PyramidSide {
  std::size_t half;      ///< which of the two half pyramids has the edge
  std::size_t opposite;  ///< the corner of that opposite the face with the edge and the centre
};

/// The sides by edges, from the i-th corner to the next, as write_half_pyramids counts corners.
constexpr std::array<PyramidSide, 4> kPyramidSides{{{0, 3}, {0, 1}, {1, 1}, {1, 2}}};

/// The slab of cells with one coordinate.
BrickMask slab(std::size_t axis, int at) noexcept {
  BrickMask cells;
  const auto place = static_cast<std::size_t>(at);
  for (std::size_t x = 0; x < 8; ++x) {
    if (axis == 0) cells.slice[x] = x == place ? ~std::uint64_t{0} : 0;
    if (axis == 1) cells.slice[x] = std::uint64_t{0xff} << (8 * place);
    if (axis == 2) cells.slice[x] = std::uint64_t{0x0101010101010101} << place;
  }
  return cells;
}

std::array<std::int64_t, 3> coordinates(BrickCoord brick) noexcept {
  return {brick.x, brick.y, brick.z};
}

/// Calls `visit(tet, direction)` for tets of a coarser brick with a face in the domain's, which
/// is opposite their first corner.
template <class Visit>
void for_each_background_face(const BackgroundCells& cells,
                              const OuterCells& outer,
                              const Visit& visit) {
  std::size_t tet = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const BrickMask pairs = internal::pairs_across(cells, axis);
    tet += 4 * std::size_t{pairs.count()};
    for (int turn = 0; turn < 4; ++turn) {
      tet += (pairs & internal::midpoints(cells, axis, turn)).count();
    }
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    tet += 8 * std::size_t{internal::faces_to_refined(cells, direction).count()};
    const internal::HalfPyramids found = internal::half_pyramids(cells, direction);
    const BrickMask& at_end = outer[static_cast<std::size_t>(direction)];
    for_each_bit(found.cells, [&](int x, int y, int z) {
      const Cell cell{x, y, z};
      std::size_t tets = 2;
      for (int turn = 0; turn < 4; ++turn) {
        tets += static_cast<std::size_t>(found.has_middle(cell, turn));
      }
      for (; tets > 0; --tets, ++tet) {
        if (at_end.test(x, y, z)) visit(tet, direction);
      }
    });
  }
}

}  // namespace

void CellBox::add(BrickCoord brick, int level, const BrickMask& leaves) noexcept {
  const std::array<std::int64_t, 3> corner = coordinates(brick);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t edge = kBrickEdge * (std::int64_t{1} << level);
    if (min[axis] <= edge * corner[axis] && edge * (corner[axis] + 1) <= max[axis]) continue;
    for (int at = 0; at < kBrickEdge; ++at) {
      if (!(leaves & slab(axis, at)).any()) continue;
      const std::int64_t cell = kBrickEdge * corner[axis] + at;
      min[axis] = std::min(min[axis], cell * (std::int64_t{1} << level));
      max[axis] = std::max(max[axis], (cell + 1) * (std::int64_t{1} << level));
    }
  }
}

OuterCells outer_cells(const CellBox& domain, BrickCoord brick, int level) noexcept {
  OuterCells outer;
  const std::array<std::int64_t, 3> corner = coordinates(brick);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t first = kBrickEdge * corner[axis];
    const std::int64_t edge = std::int64_t{1} << level;
    const std::int64_t low = (domain.min[axis] >> level) - first;
    const std::int64_t high = (domain.max[axis] >> level) - 1 - first;
    // A larger leaf than fits between the faces does not end at both.
    const auto ends_at = [&](std::int64_t cell, std::int64_t face) {
      return 0 <= cell && cell < kBrickEdge && face % edge == 0;
    };
    if (ends_at(high, domain.max[axis])) outer[axis] = slab(axis, static_cast<int>(high));
    if (ends_at(low, domain.min[axis])) outer[axis + 3] = slab(axis, static_cast<int>(low));
  }
  return outer;
}

bool any(const OuterCells& outer) noexcept {
  return std::ranges::any_of(outer, [](const BrickMask& cells) { return cells.any(); });
}

bool DomainFaces::is_dented(int x, int y, int z, int direction) const noexcept {
  if (!(*outer_)[static_cast<std::size_t>(direction)].test(x & 7, y & 7, z & 7)) return false;
  bool all_plus = nodes_.is_plus(kCentre, x, y, z);
  bool all_minus = nodes_.is_minus(kCentre, x, y, z);
  for (int turn = 0; turn < 4; ++turn) {
    const LatticeCoord c = face_turn(direction, turn);
    all_plus = all_plus && nodes_.is_plus(kCorner, x + c.x, y + c.y, z + c.z);
    all_minus = all_minus && nodes_.is_minus(kCorner, x + c.x, y + c.y, z + c.z);
  }
  return !all_plus && !all_minus;
}

int DomainFaces::direction_of(std::size_t shape) noexcept {
  return direction_of_step(
      internal::beside_edge(static_cast<int>(shape / 4), static_cast<int>(shape % 4)));
}

BrickMask DomainFaces::near_dents(const CellNodes& nodes, std::size_t shape) const noexcept {
  return nodes.pairs[shape / 4] & (*outer_)[static_cast<std::size_t>(direction_of(shape))];
}

/// The faces that have the edge and one of the two centres: each is behind the half pyramids of
/// that centre's cell.
unsigned DomainFaces::behind_dents(std::size_t shape, int x, int y, int z) const noexcept {
  const TetShape& of = kTetShape[shape];
  const int direction = direction_of(shape);
  if (!(*outer_)[static_cast<std::size_t>(direction)].test(x, y, z)) return 0;
  const LatticeCoord step = face_step(static_cast<int>(shape / 4));
  const bool first = is_dented(x, y, z, direction);
  const bool second = is_dented(x + step.x, y + step.y, z + step.z, direction);
  unsigned opposite = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (of.kind[i] != kCentre) continue;
    // Opposite the other cell's centre lies this cell's face.
    const bool is_first = of.offset[i] == 0;
    if (is_first ? second : first) opposite |= 1U << i;
  }
  return opposite;
}

std::uint64_t DomainFaces::count_behind_dents(const CellNodes& nodes,
                                              std::size_t shape) const noexcept {
  const TetShape& of = kTetShape[shape];
  const ShapeTets found = tets_of_shape(nodes, shape);
  const BrickMask tets = near_dents(nodes, shape) & (found.whole | found.cut);
  std::uint64_t count = 0;
  for_each_bit(tets, [&](int x, int y, int z) {
    const unsigned behind = behind_dents(shape, x, y, z);
    for (std::size_t k = 0; k < 4; ++k) {
      if ((behind >> k & 1) == 0) continue;
      if (found.whole.test(x, y, z)) {
        ++count;
        continue;
      }
      std::size_t plus = 0, minus = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        if (i == k) continue;
        const std::size_t at = node_around_cell(of, i);
        const bool is_plus = nodes.plus[of.kind[i]][at].test(x, y, z);
        plus += is_plus;
        minus += !is_plus && !nodes.zero[of.kind[i]][at].test(x, y, z);
      }
      count += triangles_on_face(plus, minus);
    }
  });
  return count;
}

template <class Visit>
void DomainFaces::for_each_of_half_pyramids(const BrickMask& cells,
                                            int direction,
                                            const Visit& visit) const noexcept {
  std::size_t first = 0;
  for_each_bit(cells, [&](int x, int y, int z) {
    if ((*outer_)[static_cast<std::size_t>(direction)].test(x, y, z)) {
      visit(first, std::size_t{0}, direction);
      visit(first + 1, std::size_t{0}, direction);
    }
    const int start = diagonal_turn(direction, Cell{x, y, z});
    for (int i = 0; i < 4; ++i) {
      const int beside =
          direction_of_step(internal::beside_face_edge(direction, (start + i) & 3));
      if (!is_dented(x, y, z, beside)) continue;
      const auto [half, opposite] = kPyramidSides[static_cast<std::size_t>(i)];
      visit(first + half, opposite, beside);
    }
    first += 2;
  });
}

std::uint64_t DomainFaces::count(const CellNodes& nodes) const noexcept {
  std::uint64_t count = 0;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    count += count_behind_dents(nodes, shape);
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    for_each_of_half_pyramids(half_pyramids_of_finest(nodes, direction), direction,
                              [&](auto&&...) { ++count; });
  }
  return count;
}

void DomainFaces::add_half_pyramids(const BrickMask& cells,
                                    int direction,
                                    std::size_t first,
                                    LocalFaces& faces) const noexcept {
  for_each_of_half_pyramids(cells, direction,
                            [&](std::size_t tet, std::size_t opposite, int towards) {
                              faces.add(first + tet, opposite, label_of_direction(towards));
                            });
}

std::uint64_t count_background_faces(const BackgroundCells& cells,
                                     const OuterCells& outer) noexcept {
  std::uint64_t count = 0;
  for_each_background_face(cells, outer, [&](auto&&...) { ++count; });
  return count;
}

void add_background_faces(const BackgroundCells& cells,
                          const OuterCells& outer,
                          std::size_t first,
                          LocalFaces& faces) noexcept {
  for_each_background_face(cells, outer, [&](std::size_t tet, int direction) {
    faces.add(first + tet, 0, label_of_direction(direction));
  });
}

}  // namespace tet
