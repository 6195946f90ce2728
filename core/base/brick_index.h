// From a brick's coordinate to its place in a sorted list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/heap_bytes.h"
#include "core/base/types.h"

namespace tet {

inline constexpr std::uint32_t kNoBrick = ~std::uint32_t{0};

/// Finds bricks of a list by coordinate. Immutable once built, so any number of threads may
/// ask.
class BrickIndex {
 public:
  BrickIndex() = default;
  /// `bricks` has no duplicates; it must outlive the index and stay where it is.
  explicit BrickIndex(std::span<const BrickCoord> bricks);

  /// The brick's place in the list, or kNoBrick.
  std::uint32_t find(BrickCoord brick) const noexcept;

  /// Memory it takes, beside the list.
  std::uint64_t bytes() const noexcept { return heap_bytes(slots_); }

 private:
  std::span<const BrickCoord> bricks_;
  std::vector<std::uint32_t> slots_;  // open addressing, a power of two, at most half full
};

}  // namespace tet
