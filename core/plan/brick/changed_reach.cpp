#include "core/plan/brick/changed_reach.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "core/base/brick_box.h"
#include "core/base/brick_index.h"
#include "core/plan/brick/mesh_difference.h"

namespace tet {
namespace {

/// Cells of a level, both ends included.
struct CellRange {
  VoxelCoord min, max;
};

/// Cells of an 8 x 8 x 8 brick that a range has; some.
BrickMask cells_within(const CellRange& range, BrickCoord brick) noexcept {
  const auto low = [](std::int32_t min, std::int32_t b) { return std::max(min - 8 * b, 0); };
  const auto high = [](std::int32_t max, std::int32_t b) { return std::min(max - 8 * b, 7); };
  const auto bits = [](std::int32_t from, std::int32_t to) {
    return (0xffU >> (7 - (to - from))) << from;
  };
  std::uint64_t slice = 0;
  const std::uint64_t row = bits(low(range.min.z, brick.z), high(range.max.z, brick.z));
  for (int y = low(range.min.y, brick.y); y <= high(range.max.y, brick.y); ++y) {
    slice |= row << (8 * y);
  }
  BrickMask mask;
  for (int x = low(range.min.x, brick.x); x <= high(range.max.x, brick.x); ++x) {
    mask.slice[static_cast<std::size_t>(x)] = slice;
  }
  return mask;
}

/// For each byte, bit i says whether one of its bits i * kStep - kStep to i * kStep is set.
template <int kStep>
constexpr std::array<std::uint16_t, 256> kRowReaders = [] {
  std::array<std::uint16_t, 256> readers{};
  for (unsigned row = 0; row < 256; ++row) {
    for (int i = 0; i <= 8 / kStep; ++i) {
      for (int bit = std::max(0, kStep * (i - 1)); bit <= std::min(7, kStep * i); ++bit) {
        if ((row >> bit & 1) != 0) readers[row] |= static_cast<std::uint16_t>(1U << i);
      }
    }
  }
  return readers;
}();

/// The cells, kStep times as large as a brick's own, that have one of its nodes in their closed
/// cubes. Cell (0, 0, 0) here is the one below the brick along every axis.
template <int kStep>
class NodeReaders {
 public:
  static constexpr int kEdge = 8 / kStep + 1;

  explicit NodeReaders(const BrickMask& nodes) noexcept {
    for (int x = 0; x < kEdge; ++x) {
      std::uint64_t slice = 0;
      for (int n = std::max(0, kStep * (x - 1)); n <= std::min(7, kStep * x); ++n) {
        slice |= nodes.slice[static_cast<std::size_t>(n)];
      }
      for (int y = 0; y < kEdge; ++y) {
        std::uint64_t row = 0;
        for (int n = std::max(0, kStep * (y - 1)); n <= std::min(7, kStep * y); ++n) {
          row |= slice >> (8 * n);
        }
        rows_[place(x, y)] = kRowReaders<kStep>[row & 0xff];
      }
    }
  }

  /// Those in an 8 x 8 x 8 brick of their size, of which (x, y, z) is their cell (0, 0, 0).
  BrickMask within(int x, int y, int z) const noexcept {
    BrickMask mask;
    for (int i = std::max(0, -x); i < std::min(kEdge, 8 - x); ++i) {
      std::uint64_t& slice = mask.slice[static_cast<std::size_t>(x + i)];
      for (int j = std::max(0, -y); j < std::min(kEdge, 8 - y); ++j) {
        const std::uint64_t row = rows_[place(i, j)];
        slice |= ((z < 0 ? row >> -z : row << z) & 0xff) << (8 * (y + j));
      }
    }
    return mask;
  }

 private:
  static constexpr std::size_t place(int x, int y) noexcept {
    return static_cast<std::size_t>(x * kEdge + y);
  }

  std::array<std::uint16_t, std::size_t{kEdge} * kEdge> rows_;
};

/// All cells at most one away from some of these, which are not none.
CellRange around(const BrickMask& cells, BrickCoord brick) noexcept {
  std::uint64_t all = 0;
  std::int32_t first = 8, last = -1;
  for (std::int32_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = cells.slice[static_cast<std::size_t>(x)];
    all |= slice;
    if (slice == 0) continue;
    first = std::min(first, x);
    last = x;
  }
  std::uint64_t row = 0;
  for (int y = 0; y < 8; ++y) row |= all >> (8 * y) & 0xff;
  const auto low_y = static_cast<std::int32_t>(std::countr_zero(all) / 8);
  const auto high_y = static_cast<std::int32_t>((63 - std::countl_zero(all)) / 8);
  const auto low_z = static_cast<std::int32_t>(std::countr_zero(row));
  const auto high_z = static_cast<std::int32_t>(63 - std::countl_zero(row));
  return {{8 * brick.x + first - 1, 8 * brick.y + low_y - 1, 8 * brick.z + low_z - 1},
          {8 * brick.x + last + 1, 8 * brick.y + high_y + 1, 8 * brick.z + high_z + 1}};
}

class Marker {
 public:
  Marker(const OctreeLevel& level, std::vector<std::uint32_t>& tets)
      : level_(level), tets_(tets) {}

  /// Marks the bricks that have a leaf among these cells.
  void mark(const CellRange& cells) {
    const BrickBox bricks{{cells.min.x >> 3, cells.min.y >> 3, cells.min.z >> 3},
                          {cells.max.x >> 3, cells.max.y >> 3, cells.max.z >> 3}};
    mark(bricks, [&](BrickCoord brick) { return cells_within(cells, brick); });
  }

  /// Marks the bricks with a leaf that has one of these nodes, of a brick whose cells are a
  /// kStep-th as large.
  template <int kStep>
  void mark_readers_of(const BrickMask& nodes, BrickCoord of) {
    if (!nodes.any()) return;
    const NodeReaders<kStep> readers(nodes);
    const VoxelCoord first{8 / kStep * of.x - 1, 8 / kStep * of.y - 1, 8 / kStep * of.z - 1};
    const auto last = [](std::int32_t c) { return (c + NodeReaders<kStep>::kEdge - 1) >> 3; };
    mark({{first.x >> 3, first.y >> 3, first.z >> 3},
          {last(first.x), last(first.y), last(first.z)}},
         [&](BrickCoord brick) {
           return readers.within(first.x - 8 * brick.x, first.y - 8 * brick.y,
                                 first.z - 8 * brick.z);
         });
  }

 private:
  template <class CellsOf>
  void mark(const BrickBox& bricks, const CellsOf& cells_of) {
    for_each_brick(bricks, [&](BrickCoord brick) {
      const std::uint32_t at = level_.index.find(brick);
      if (at == kNoBrick || tets_[at] == kNewBrick) return;
      if ((level_.leaf[at] & cells_of(brick)).any()) tets_[at] = kNewBrick;
    });
  }

  const OctreeLevel& level_;
  std::vector<std::uint32_t>& tets_;
};

}  // namespace

void mark_readers(std::span<const std::vector<ChangedBrick>> changed,
                  const OctreeLevel& level,
                  std::vector<std::uint32_t>& tets) {
  Marker marker(level, tets);
  const std::size_t own = changed.size() - 1;
  for (const ChangedBrick& brick : changed[own]) {
    marker.mark_readers_of<1>(brick.nodes, brick.brick);
    if (brick.cells.any()) marker.mark(around(brick.cells, brick.brick));
  }
  if (own < 1) return;
  for (const ChangedBrick& brick : changed[own - 1]) {
    marker.mark_readers_of<2>(brick.corners, brick.brick);
  }
  if (own < 2) return;
  for (const ChangedBrick& brick : changed[own - 2]) {
    marker.mark_readers_of<4>(brick.corners, brick.brick);
  }
}

}  // namespace tet
