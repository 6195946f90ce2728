// What two tets have in common, as tets.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/types.h"
#include "core/base/vec3.h"

namespace tet {

using TetPlaces = std::array<WorldPoint, 4>;

/// Cuts tets by planes. It owns the memory of the pieces: one per task.
class CommonPart {
 public:
  /// The part of `one` that lies in `other`, as tets that touch each other; they stay until the
  /// next call. `other` may be turned over; pieces are turned as `one` is. A flat tet has no
  /// part of another one.
  std::span<const TetPlaces> of(const TetPlaces& one, const TetPlaces& other) noexcept;

 private:
  /// Cutting a tet leaves three at most, and there are four planes.
  static constexpr std::size_t kMost = 81;
  struct Pieces {
    std::array<TetPlaces, kMost> tet;
    std::size_t count = 0;
  };
  static void cut(const TetPlaces& tet,
                  const std::array<double, 4>& height,
                  Pieces& kept) noexcept;

  std::array<Pieces, 2> pieces_;  ///< before and after a cut, in turn
};

}  // namespace tet
