#include "core/octree/cell_set.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"

namespace tet {
namespace {

BrickCoord parent_of(BrickCoord brick) noexcept {
  return {brick.x >> 1, brick.y >> 1, brick.z >> 1};
}

/// The even bits of each 16 as its lower 8; the odd ones must not be set.
std::uint64_t even_bits(std::uint64_t bits) noexcept {
  bits = (bits | bits >> 1) & 0x3333333333333333;
  bits = (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0f;
  return (bits | bits >> 4) & 0x00ff00ff00ff00ff;
}

/// Finds the parents of a brick's own cells alone: they fill an eighth of the parent's brick.
BrickMask parents(const BrickMask& cells, BrickCoord brick) noexcept {
  const auto ox = static_cast<std::size_t>((brick.x & 1) * 4);
  const int oy = (brick.y & 1) * 4, oz = (brick.z & 1) * 4;
  BrickMask out;
  for (std::size_t x = 0; x < 4; ++x) {
    std::uint64_t children = cells.slice[2 * x] | cells.slice[2 * x + 1];
    children |= children >> kBrickEdge;
    std::uint64_t rows = even_bits((children | children >> 1) & 0x0055005500550055);
    rows = (rows | rows >> 8) & 0x0000ffff0000ffff;
    rows = (rows | rows >> 16) & 0x00000000ffffffff;
    out.slice[ox + x] = rows << (oy * kBrickEdge + oz);
  }
  return out;
}

/// The set with all that share a face or an edge with it: along any two axes at once.
HaloSet with_face_and_edge_neighbours(const HaloSet& cells) noexcept {
  constexpr int kX = offset_index(1, 0, 0), kY = offset_index(0, 1, 0),
                kZ = offset_index(0, 0, 1);
  const auto along = [](const HaloSet& set, int step) {
    return set | seen_from(set, step) | seen_from(set, -step);
  };
  const HaloSet z = along(cells, kZ);
  return along(z, kY) | along(z, kX) | along(along(cells, kY), kX);
}

/// One axis of the parents of a brick's cells: six of them, from the one before the brick's
/// four to the one after. `even` and `odd` are those of cells that are the lower, or the upper,
/// of a pair, four of each; `step` is how far apart parents are.
struct ParentsAlong {
  std::uint64_t within;   ///< the cells' own parents
  std::uint64_t reached;  ///< those, and the ones next to a cell
};
ParentsAlong along_axis(std::uint64_t even, std::uint64_t odd, int step) noexcept {
  const std::uint64_t within = (even | odd) << step;
  return {within, within | even | odd << 2 * step};
}

/// The six parents along z, a byte for each row.
ParentsAlong parents_along_z(std::uint64_t slice) noexcept {
  constexpr std::uint64_t kEven = 0x5555555555555555;
  const auto nibbles = [](std::uint64_t bits) {
    bits = (bits | bits >> 1) & 0x3333333333333333;
    return (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0f;
  };
  return along_axis(nibbles(slice & kEven), nibbles(slice >> 1 & kEven), 1);
}

/// The six rows of parents along y, from eight rows.
ParentsAlong parents_along_y(std::uint64_t rows) noexcept {
  constexpr std::uint64_t kEven = 0x00ff00ff00ff00ff;
  const auto pack_rows = [](std::uint64_t bytes) {
    bytes = (bytes | bytes >> 8) & 0x0000ffff0000ffff;
    return (bytes | bytes >> 16) & 0x00000000ffffffff;
  };
  return along_axis(pack_rows(rows & kEven), pack_rows(rows >> 8 & kEven), kBrickEdge);
}

/// The parents of a brick's cells and of all that share a face or an edge with one: six along
/// each axis, the first of them beyond the brick.
using ParentsAround = std::array<std::uint64_t, 6>;

ParentsAround parents_around(const BrickMask& cells) noexcept {
  // A cell beside a parent shares a face or an edge with one of its cells unless it is beyond
  // it along all three axes.
  std::array<std::uint64_t, 8> two{},
      one{};  // reached along y and z; along at most one of them
  for (std::size_t x = 0; x < 8; ++x) {
    if (cells.slice[x] == 0) continue;
    const ParentsAlong z = parents_along_z(cells.slice[x]);
    const ParentsAlong within = parents_along_y(z.within), reached = parents_along_y(z.reached);
    two[x] = reached.reached;
    one[x] = reached.within | within.reached;
  }
  ParentsAround parents;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const auto at = [&](const auto& slices, std::size_t x) { return x < 8 ? slices[x] : 0; };
    const std::size_t low = 2 * i - 2;  // the lower of the parent's cells; below 0 it is huge
    parents[i] = at(two, low) | at(two, low + 1) | at(one, low) | at(one, low + 1) |
                 at(one, low - 1) | at(one, low + 2);
  }
  return parents;
}

/// The part of six parents along z, a byte for each row, that lies in the lower, or the upper,
/// of the two bricks that they reach into; `upper_half` says which half of its parent along the
/// axis the brick is.
std::uint64_t part_along_z(std::uint64_t rows, bool upper_half, bool upper) noexcept {
  constexpr std::uint64_t kFirst = 0x0101010101010101, kFive = 31 * kFirst;
  if (upper_half) return upper ? rows >> 5 & kFirst : (rows & kFive) << 3;
  return upper ? rows >> 1 & kFive : (rows & kFirst) << 7;
}

/// Does the same with six rows along y.
std::uint64_t part_along_y(std::uint64_t rows, bool upper_half, bool upper) noexcept {
  constexpr std::uint64_t kFirst = 0xff, kFive = 0xffffffffff;
  if (upper_half) return upper ? rows >> 40 & kFirst : (rows & kFive) << 24;
  return upper ? rows >> 8 & kFive : (rows & kFirst) << 56;
}

/// Hands the bricks around a parent's their parts of what its child `brick` reaches.
void add_parts(CellSetBuilder& builder, BrickCoord brick, const ParentsAround& parents) {
  const BrickCoord parent = parent_of(brick);
  const bool half_x = (brick.x & 1) != 0, half_y = (brick.y & 1) != 0,
             half_z = (brick.z & 1) != 0;
  for (int o = 0; o < 8; ++o) {
    const bool upper_x = (o & 4) != 0, upper_y = (o & 2) != 0, upper_z = (o & 1) != 0;
    BrickMask part;
    for (std::size_t i = 0; i < parents.size(); ++i) {
      const std::size_t x = i + (half_x ? 3 : 7);  // from the lower brick's first
      if ((x >= 8) != upper_x) continue;
      part.slice[x & 7] =
          part_along_y(part_along_z(parents[i], half_z, upper_z), half_y, upper_y);
    }
    if (!part.any()) continue;
    builder.add({parent.x + (o >> 2) - !half_x, parent.y + (o >> 1 & 1) - !half_y,
                 parent.z + (o & 1) - !half_z},
                part);
  }
}

/// The 4 x 4 cells at the start of a slice, each as 2 x 2 of them.
std::uint64_t doubled(std::uint64_t slice) noexcept {
  std::uint64_t bits = slice & 0x0f0f0f0f;
  bits = (bits | bits << 16) & 0x00000f0f00000f0f;
  bits = (bits | bits << 8) & 0x000f000f000f000f;
  bits = (bits | bits << 2) & 0x0033003300330033;
  bits = (bits | bits << 1) & 0x0055005500550055;
  bits |= bits << 1;
  return bits | bits << 8;
}

/// The part of a parent brick's mask that covers child (ox, oy, oz), spread to the child's
/// cells.
BrickMask children_of(const BrickMask& parent_cells, int ox, int oy, int oz) noexcept {
  BrickMask mask;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = parent_cells.slice[static_cast<std::size_t>(ox * 4) + x / 2];
    mask.slice[x] = doubled(slice >> (32 * oy + 4 * oz));
  }
  return mask;
}

template <class Masks>
HaloSet gather_halo_of(const Masks& masks, const PlacesAround& around) noexcept {
  HaloSet set;
  if (masks.empty()) return set;
  for (int o = 0; o < 27; ++o) {
    const std::uint32_t at = around[static_cast<std::size_t>(o)];
    if (at != kNoBrick) add_brick(set, masks[at], o / 9 - 1, o / 3 % 3 - 1, o % 3 - 1);
  }
  return set;
}

/// The bricks of a set and those around them, where they have cells after at most two steps.
CellSet grown_by(const CellSet& cells, int steps, const Cancellation& cancellation) {
  CellSet out{with_neighbours(cells.bricks), {}};
  out.cells.resize(out.bricks.size());
  for_each_range(out.bricks.size(), 16, [&](std::size_t begin, std::size_t end) {
    BrickNeighbours neighbours(cells.bricks);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      HaloSet around = gather_halo(cells.cells, neighbours.around(out.bricks[i]));
      for (int step = 0; step < steps; ++step) around = with_face_and_edge_neighbours(around);
      out.cells[i] = brick_part(around);
    }
  });
  return out;
}

/// What `add(builder, i)` adds of each of a set's bricks, side by side.
template <class Add>
CellSet build_from(const CellSet& cells, const Cancellation& cancellation, const Add& add) {
  constexpr std::size_t kBricksPerBlock = 32;
  const std::size_t bricks = cells.bricks.size();
  std::vector<CellSetBuilder> blocks((bricks + kBricksPerBlock - 1) / kBricksPerBlock);
  for_each_index(blocks.size(), [&](std::size_t block) {
    const std::size_t end = std::min(bricks, (block + 1) * kBricksPerBlock);
    for (std::size_t i = block * kBricksPerBlock; i < end && !cancellation.requested(); ++i) {
      add(blocks[block], i);
    }
  });
  CellSetBuilder all;
  for (CellSetBuilder& block : blocks) all.add(std::move(block));
  return all.take();
}

}  // namespace

void CellSetBuilder::add(CellSetBuilder&& other) {
  parts_.insert(parts_.end(), std::make_move_iterator(other.parts_.begin()),
                std::make_move_iterator(other.parts_.end()));
}

CellSet CellSetBuilder::take() {
  CellSet set;
  set.bricks.reserve(parts_.size());
  for (const auto& [brick, cells] : parts_) set.bricks.push_back(brick);
  sort_unique(set.bricks);
  set.cells.resize(set.bricks.size());
  const BrickIndex index(set.bricks);
  for (const auto& [brick, cells] : parts_) set.cells[index.find(brick)] |= cells;
  parts_.clear();
  return set;
}

HaloSet gather_halo(const std::vector<BrickMask>& masks, const PlacesAround& around) noexcept {
  return gather_halo_of(masks, around);
}

HaloSet gather_halo(const MaskColumn& masks, const PlacesAround& around) noexcept {
  return gather_halo_of(masks, around);
}

CellSet parents_of(const CellSet& cells, const Cancellation& cancellation) {
  return build_from(cells, cancellation, [&](CellSetBuilder& builder, std::size_t i) {
    if (!cells.cells[i].any()) return;
    builder.add(parent_of(cells.bricks[i]), parents(cells.cells[i], cells.bricks[i]));
  });
}

CellSet parents_with_neighbours(const CellSet& cells, const Cancellation& cancellation) {
  return build_from(cells, cancellation, [&](CellSetBuilder& builder, std::size_t i) {
    add_parts(builder, cells.bricks[i], parents_around(cells.cells[i]));
  });
}

CellSet children_of(const CellSet& parents, const Cancellation& cancellation) {
  return build_from(parents, cancellation, [&](CellSetBuilder& builder, std::size_t i) {
    const BrickCoord p = parents.bricks[i];
    for (int o = 0; o < 8; ++o) {
      const int ox = o >> 2, oy = o >> 1 & 1, oz = o & 1;
      const BrickMask mask = children_of(parents.cells[i], ox, oy, oz);
      if (mask.any()) builder.add({2 * p.x + ox, 2 * p.y + oy, 2 * p.z + oz}, mask);
    }
  });
}

BrickMask children_within(const BrickMask& parent_cells, BrickCoord brick) noexcept {
  return children_of(parent_cells, brick.x & 1, brick.y & 1, brick.z & 1);
}

void drop_empty(CellSet& cells) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cells.bricks.size(); ++i) {
    if (!cells.cells[i].any()) continue;
    cells.bricks[kept] = cells.bricks[i];
    cells.cells[kept++] = cells.cells[i];
  }
  cells.bricks.resize(kept);
  cells.cells.resize(kept);
}

CellSet grown(CellSet cells, int steps, const Cancellation& cancellation) {
  constexpr int kHalo = 2;  // as far as a halo reaches
  drop_empty(cells);
  for (; steps > 0 && !cancellation.requested(); steps -= kHalo) {
    cells = grown_by(cells, std::min(steps, kHalo), cancellation);
    drop_empty(cells);
  }
  return cells;
}

void unite(CellSet& cells, const CellSet& more) {
  if (more.bricks.empty()) return;
  CellSetBuilder builder;
  for (const CellSet* set : {&std::as_const(cells), &more}) {
    for (std::size_t i = 0; i < set->bricks.size(); ++i) {
      builder.add(set->bricks[i], set->cells[i]);
    }
  }
  cells = builder.take();
}

}  // namespace tet
