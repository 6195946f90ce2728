// The bricks around one brick after another of a sorted list.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/brick_index.h"
#include "core/base/types.h"

namespace tet {

/// Places in the list, or kNoBrick: a brick and the 26 around it, at 9*(x+1) + 3*(y+1) + z+1.
using PlacesAround = std::array<std::uint32_t, 27>;

inline constexpr std::size_t kItself = 13;

/// Looks up one brick and those around it. The brick need not be in the index.
PlacesAround places_around(const BrickIndex& index, BrickCoord brick) noexcept;

/// Walks along a sorted list of bricks: nine places move through it, one for each row of three
/// bricks along z, so that going to the next brick costs a few comparisons and no hashing. Not
/// thread-safe: one per task.
class BrickNeighbours {
 public:
  /// `bricks` are sorted and unique; they must outlive this.
  explicit BrickNeighbours(std::span<const BrickCoord> bricks) : bricks_(bricks) {}

  /// Where the bricks around `brick` are; it need not be in the list, but comes after those
  /// asked for before.
  const PlacesAround& around(BrickCoord brick) noexcept;

 private:
  std::span<const BrickCoord> bricks_;
  bool started_ = false;
  std::array<std::size_t, 9> row_{};  // the first brick not before the row of three
  PlacesAround places_{};
};

}  // namespace tet
