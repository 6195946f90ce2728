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

/// Which rows of bricks around one are looked for, by their steps along x and y: all nine; the
/// four with none upwards, or none downwards; or the five that hold the bricks after it.
enum class RowsAround : std::uint16_t {
  kAll = 0x1ff,
  kLower = 0x01b,
  kUpper = 0x1b0,
  kLater = 0x1f0,
};

/// Walks along a sorted list of bricks: nine places move through it, one for each row of three
/// bricks along z, so that going to the next brick costs a few comparisons and no hashing. Not
/// thread-safe: one per task.
class BrickNeighbours {
 public:
  /// `bricks` are sorted and unique; they must outlive this.
  explicit BrickNeighbours(std::span<const BrickCoord> bricks,
                           RowsAround rows = RowsAround::kAll)
      : bricks_(bricks), rows_(rows) {
    places_.fill(kNoBrick);
  }

  /// Where the bricks around `brick` are, kNoBrick for those of rows that are not looked for;
  /// it need not be in the list, but comes after those asked for before.
  const PlacesAround& around(BrickCoord brick) noexcept;

 private:
  std::span<const BrickCoord> bricks_;
  RowsAround rows_;
  /// Goes on to the next brick along z.
  void move_along_z(BrickCoord brick) noexcept;

  bool started_ = false;
  BrickCoord last_;                   // asked for
  std::array<std::size_t, 9> row_{};  // the first brick not before the row of three
  PlacesAround places_{};
};

}  // namespace tet
