// Which bricks of a mesh are those of an earlier one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_index.h"
#include "core/base/brick_mask.h"
#include "core/base/heap_bytes.h"

namespace tet {

inline constexpr std::uint32_t kNewBrick = kNoBrick;

/// Where each brick of a level is in the earlier mesh's level, kNewBrick where it is not.
using BrickPlaces = std::vector<std::uint32_t>;

/// What of a brick is kept where not all is.
enum class PatchDetail : std::uint8_t {
  kWhole,   ///< nothing: of all the fewest runs
  kBricks,  ///< the vertices that lie where they lay, and none of the tets
  kSlices,  ///< these, and tets of each slice of 64 finest cells that read nothing that changed
};

/// Cells of some of a level's bricks.
class ReadCells {
 public:
  /// None yet, of so many bricks.
  explicit ReadCells(std::size_t bricks = 0) : place_(bricks, kNewBrick) {}

  void add(std::uint32_t brick, const BrickMask& more);
  /// Returns the cells of a brick that were added; most bricks have none.
  BrickMask of(std::size_t brick) const noexcept {
    return place_[brick] == kNewBrick ? BrickMask{} : cells_[place_[brick]];
  }
  std::uint64_t bytes() const noexcept { return all_heap_bytes(place_, cells_); }

 private:
  std::vector<std::uint32_t> place_;  ///< of each brick, in cells_
  std::vector<BrickMask> cells_;
};

/// Says for each brick of a level which brick of the earlier mesh's level has its vertices, or
/// its tets: kNewBrick where none has.
///
/// Where a brick's vertices are not kept, `nodes` says which brick it was: it has some of its
/// vertices as it had them. Where its tets are not, those of all cells but `read` are what they
/// were: at the finest level, as others have none there.
struct KeptBricks {
  BrickPlaces vertices, tets, nodes;
  ReadCells read;
};

}  // namespace tet
