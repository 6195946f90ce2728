// Which cells of an octree level a domain holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/field/find_bricks.h"

namespace tet {

/// Cells of one level that a domain holds.
class DomainCells {
 public:
  DomainCells(const BrickBox& domain, int level) {
    const auto range = [&](std::int32_t min_brick, std::int32_t max_brick) {
      const std::int64_t begin = std::int64_t{8} * min_brick;
      const std::int64_t end = std::int64_t{8} * max_brick + 8;
      const std::int64_t before_next = (std::int64_t{1} << level) - 1;
      return Range{(begin + before_next) >> level, (end >> level) - 1, begin >> level,
                   (end - 1) >> level};
    };
    axis_ = {range(domain.min.x, domain.max.x), range(domain.min.y, domain.max.y),
             range(domain.min.z, domain.max.z)};
  }

  /// The cells that lie in the domain whole.
  BrickMask whole(BrickCoord brick) const noexcept {
    return mask(brick, [](const Range& r, std::int64_t i) {
      return i >= r.first_whole && i <= r.last_whole;
    });
  }
  /// The cells that the domain reaches into.
  BrickMask touched(BrickCoord brick) const noexcept {
    return mask(brick,
                [](const Range& r, std::int64_t i) { return i >= r.first && i <= r.last; });
  }
  /// True when no cell sticks out of the domain.
  bool all_whole() const noexcept {
    return std::ranges::all_of(axis_, [](const Range& r) {
      return r.first == r.first_whole && r.last == r.last_whole;
    });
  }
  /// The bricks of the level that it reaches into.
  BrickBox bricks() const noexcept {
    const auto at = [&](std::int64_t Range::*end) {
      return BrickCoord{static_cast<std::int32_t>(axis_[0].*end >> 3),
                        static_cast<std::int32_t>(axis_[1].*end >> 3),
                        static_cast<std::int32_t>(axis_[2].*end >> 3)};
    };
    return {at(&Range::first), at(&Range::last)};
  }

 private:
  struct Range {
    std::int64_t first_whole, last_whole, first, last;
  };

  template <class Holds>
  BrickMask mask(BrickCoord brick, const Holds& holds) const noexcept {
    const auto bits = [&](const Range& range, std::int32_t b) {
      unsigned set = 0;
      for (unsigned i = 0; i < 8; ++i) {
        if (holds(range, std::int64_t{8} * b + i)) set |= 1U << i;
      }
      return static_cast<std::uint8_t>(set);
    };
    return cells_at(bits(axis_[0], brick.x), bits(axis_[1], brick.y), bits(axis_[2], brick.z));
  }

  std::array<Range, 3> axis_;
};

}  // namespace tet
