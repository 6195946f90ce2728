#include "core/lattice/background.h"

#include <array>
#include <bit>
#include <cstddef>

#include "core/base/vector_clones.h"
#include "core/lattice/background_tets.h"
#include "core/lattice/node_numbers.h"
#include "core/lattice/reach.h"
#include "core/octree/octree.h"

namespace tet {
namespace {

/// Ids around one brick, looked up once each: corners of the level below, 17 along each edge.
template <class Index>
class BrickIds {
 public:
  BrickIds(NodeNumbers& numbers, int level, BrickCoord brick)
      : numbers_(numbers), level_(level), brick_(brick) {
    ids_.fill(kUnknown);
    numbers.for_each_corner(level, brick, [&](int x, int y, int z, std::uint64_t id) {
      ids_[place(x, y, z)] = static_cast<Index>(id);
    });
    for (std::size_t o = 0; o < centre_.size(); ++o) {
      const UpperOffset at(o);
      if (at.x + at.y + at.z > 1) continue;  // tets reach across faces only
      const auto centres =
          numbers.centres(level, {brick.x + at.x, brick.y + at.y, brick.z + at.z});
      centre_[o].mask = centres.mask;
      std::uint64_t next = centres.first;
      for (std::size_t x = 0; x < 8; ++x) {
        centre_[o].first_of_slice[x] = static_cast<Index>(next);
        next += static_cast<std::uint64_t>(std::popcount(centres.mask->slice[x]));
      }
    }
  }

  /// Corner at twice the cell coordinates, so that midpoints have whole ones.
  Index finer_corner(int x, int y, int z) noexcept {
    Index& id = ids_[place(x, y, z)];
    if (id == kUnknown) {  // two levels below, or nowhere
      id = static_cast<Index>(numbers_.finer_corner(level_, brick_, x, y, z));
    }
    return id;
  }
  Index centre(int x, int y, int z) noexcept {
    const auto o = static_cast<std::size_t>((x >> 3) * 4 + (y >> 3) * 2 + (z >> 3));
    const auto slice = static_cast<std::size_t>(x & 7);
    const std::uint64_t bit = std::uint64_t{1} << ((y & 7) * 8 + (z & 7));
    return centre_[o].first_of_slice[slice] +
           static_cast<Index>(std::popcount(centre_[o].mask->slice[slice] & (bit - 1)));
  }

 private:
  struct Centres {
    const BrickMask* mask;
    std::array<Index, 8> first_of_slice;
  };

  static constexpr Index kUnknown = ~Index{0};

  static constexpr std::size_t place(int x, int y, int z) noexcept {
    return static_cast<std::size_t>((x * 17 + y) * 17 + z);
  }

  NodeNumbers& numbers_;
  int level_;
  BrickCoord brick_;
  std::array<Centres, 8> centre_;
  std::array<Index, std::size_t{17} * 17 * 17> ids_;
};

}  // namespace

BackgroundCells gather_background(const OctreeLevel& level,
                                  BrickCoord brick,
                                  MeshRegion region) noexcept {
  return gather_background(level, places_around(level.index, brick), region);
}

BackgroundCells gather_background(const OctreeLevel& level,
                                  const PlacesAround& around,
                                  MeshRegion region) noexcept {
  BackgroundCells cells{gather_halo(level.leaf, around), gather_halo(level.refined, around),
                        BrickMask::all()};
  if (level.inside.empty()) return cells;
  // A brick's tets are those of its own cells: no others' sides matter.
  const BrickMask& inside = level.inside[around[kItself]];
  cells.own = region == MeshRegion::kInside ? inside : ~inside;
  return cells;
}

BackgroundCounts count_background(const BackgroundCells& cells) noexcept {
  BackgroundCounts counts;
  for (int axis = 0; axis < 3; ++axis) {
    const BrickMask pairs = internal::pairs_across(cells, axis);
    std::uint64_t halved = 0;
    for (int turn = 0; turn < 4; ++turn) {
      halved += (pairs & internal::midpoints(cells, axis, turn)).count();
    }
    counts.bcc += 4 * std::uint64_t{pairs.count()} - halved;
    counts.bisected += 2 * halved;
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    counts.quadrisected +=
        8 * std::uint64_t{internal::faces_to_refined(cells, direction).count()};
    const internal::HalfPyramids found = internal::half_pyramids(cells, direction);
    for_each_bit(found.cells, [&](int x, int y, int z) {
      const Cell cell{x, y, z};
      const int start = diagonal_turn(direction, cell);
      for (const int half : {0, 2}) {
        const int midpoints =
            found.has_middle(cell, start + half) + found.has_middle(cell, start + half + 1);
        counts.half_pyramid += midpoints == 0;
        counts.halved += midpoints == 1;
        counts.in_three += midpoints == 2;
      }
    });
  }
  return counts;
}

template <class Index>
TET_VECTOR_CLONES Index* fill_background(const BackgroundCells& cells,
                                         NodeNumbers& numbers,
                                         int level,
                                         BrickCoord brick,
                                         Index* tets,
                                         BackgroundCounts& counts) noexcept {
  BrickIds<Index> ids(numbers, level, brick);
  return write_background(cells, ids, tets, counts);
}

template std::uint32_t* fill_background(const BackgroundCells&,
                                        NodeNumbers&,
                                        int,
                                        BrickCoord,
                                        std::uint32_t*,
                                        BackgroundCounts&) noexcept;
template std::uint64_t* fill_background(const BackgroundCells&,
                                        NodeNumbers&,
                                        int,
                                        BrickCoord,
                                        std::uint64_t*,
                                        BackgroundCounts&) noexcept;

}  // namespace tet
