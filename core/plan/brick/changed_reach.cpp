#include "core/plan/brick/changed_reach.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_box.h"
#include "core/base/brick_index.h"
#include "core/plan/brick/mesh_difference.h"

namespace tet {
namespace {

/// Which of a brick's nodes, or cells, a cell reads along an axis: cell i, kStep times as large
/// as those of the brick, reads kStep * i - kBack to kStep * i. Cell 0 is the one below the
/// brick.
template <int kStep, int kBack>
struct Reads {
  static constexpr int kCells = (7 + kBack) / kStep + 1;  ///< that read any
  static constexpr int first(int cell) noexcept { return std::max(0, kStep * cell - kBack); }
  static constexpr int last(int cell) noexcept { return std::min(7, kStep * cell); }
};

/// The closed cubes of cells, by nodes.
template <int kStep>
using ReadsNodes = Reads<kStep, kStep>;
/// All cells at most one away.
using ReadsCells = Reads<1, 2>;

/// For each byte, bit i says whether one of the bits that cell i reads is set.
template <class Read>
constexpr std::array<std::uint16_t, 256> kRowReaders = [] {
  std::array<std::uint16_t, 256> readers{};
  for (unsigned row = 0; row < 256; ++row) {
    for (int i = 0; i < Read::kCells; ++i) {
      for (int bit = Read::first(i); bit <= Read::last(i); ++bit) {
        if ((row >> bit & 1) != 0) readers[row] |= static_cast<std::uint16_t>(1U << i);
      }
    }
  }
  return readers;
}();

/// The cells that read some of a brick's nodes, or cells.
template <class Read>
class Readers {
 public:
  static constexpr int kEdge = Read::kCells;

  explicit Readers(const BrickMask& nodes) noexcept {
    for (int x = 0; x < kEdge; ++x) {
      std::uint64_t slice = 0;
      for (int n = Read::first(x); n <= Read::last(x); ++n) {
        slice |= nodes.slice[static_cast<std::size_t>(n)];
      }
      for (int y = 0; y < kEdge; ++y) {
        std::uint64_t row = 0;
        for (int n = Read::first(y); n <= Read::last(y); ++n) row |= slice >> (8 * n);
        rows_[place(x, y)] = kRowReaders<Read>[row & 0xff];
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

class Marker {
 public:
  Marker(const OctreeLevel& level, BrickPlaces& tets, ReadCells* read)
      : level_(level), tets_(tets), read_(read) {}

  /// Marks the bricks with a leaf that reads some of these, of a brick whose cells are a
  /// kStep-th as large.
  template <class Read, int kStep>
  void mark(const BrickMask& changed, BrickCoord of) {
    if (!changed.any()) return;
    const Readers<Read> readers(changed);
    const VoxelCoord first{8 / kStep * of.x - 1, 8 / kStep * of.y - 1, 8 / kStep * of.z - 1};
    const auto last = [](std::int32_t c) { return (c + Readers<Read>::kEdge - 1) >> 3; };
    const BrickBox bricks{{first.x >> 3, first.y >> 3, first.z >> 3},
                          {last(first.x), last(first.y), last(first.z)}};
    for_each_brick(bricks, [&](BrickCoord brick) {
      const std::uint32_t at = level_.index.find(brick);
      if (at == kNoBrick || is_marked(at)) return;
      const BrickMask cells =
          level_.leaf[at] &
          readers.within(first.x - 8 * brick.x, first.y - 8 * brick.y, first.z - 8 * brick.z);
      if (!cells.any()) return;
      tets_[at] = kNewBrick;
      if (read_ != nullptr) read_->add(at, cells);
    });
  }

 private:
  /// Whether there is nothing more to find of a brick.
  bool is_marked(std::uint32_t at) const noexcept {
    if (tets_[at] != kNewBrick) return false;
    return read_ == nullptr || !(level_.leaf[at] & ~read_->of(at)).any();
  }

  const OctreeLevel& level_;
  BrickPlaces& tets_;
  ReadCells* read_;
};

}  // namespace

void ReadCells::add(std::uint32_t brick, const BrickMask& more) {
  if (place_[brick] == kNewBrick) {
    place_[brick] = static_cast<std::uint32_t>(cells_.size());
    cells_.emplace_back();
  }
  cells_[place_[brick]] |= more;
}

void mark_readers(std::span<const std::vector<ChangedBrick>> changed,
                  const OctreeLevel& level,
                  BrickPlaces& tets,
                  ReadCells* read) {
  Marker marker(level, tets, read);
  const std::size_t own = changed.size() - 1;
  for (const ChangedBrick& brick : changed[own]) {
    marker.mark<ReadsNodes<1>, 1>(brick.nodes, brick.brick);
    marker.mark<ReadsCells, 1>(brick.cells, brick.brick);
  }
  if (own < 1) return;
  for (const ChangedBrick& brick : changed[own - 1]) {
    marker.mark<ReadsNodes<2>, 2>(brick.corners, brick.brick);
  }
  if (own < 2) return;
  for (const ChangedBrick& brick : changed[own - 2]) {
    marker.mark<ReadsNodes<4>, 4>(brick.corners, brick.brick);
  }
}

}  // namespace tet
