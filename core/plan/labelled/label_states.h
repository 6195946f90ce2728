// What each finest brick of a box of labels is, as a dense array: boxes of segmentations are
// full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_box.h"
#include "core/base/heap_bytes.h"
#include "core/labels/label.h"

namespace tet {

/// A surveyed brick's place, or the label that fills a brick.
class BrickState {
 public:
  static constexpr BrickState of_label(Label label) noexcept {
    return BrickState(kOne | label);
  }
  static constexpr BrickState at(std::uint32_t place) noexcept { return BrickState(place); }
  constexpr BrickState() noexcept = default;

  constexpr bool one() const noexcept { return (bits_ & kOne) != 0; }
  constexpr Label label() const noexcept { return static_cast<Label>(bits_); }
  constexpr std::uint32_t place() const noexcept { return bits_; }

 private:
  static constexpr std::uint32_t kOne = std::uint32_t{1} << 31;
  constexpr explicit BrickState(std::uint32_t bits) noexcept : bits_(bits) {}
  std::uint32_t bits_ = kOne;
};

/// States of all bricks of a box, in their order.
class LabelStates {
 public:
  LabelStates() = default;
  explicit LabelStates(const BrickBox& box)
      : box_(box),
        y_(static_cast<std::size_t>(box.max.y - box.min.y + 1)),
        z_(static_cast<std::size_t>(box.max.z - box.min.z + 1)),
        state_(static_cast<std::size_t>(box.max.x - box.min.x + 1) * y_ * z_) {}

  std::size_t size() const noexcept { return state_.size(); }
  BrickState& operator[](std::size_t i) noexcept { return state_[i]; }
  BrickCoord brick(std::size_t i) const noexcept {
    const auto at = [](std::int32_t min, std::size_t step) {
      return min + static_cast<std::int32_t>(step);
    };
    return {at(box_.min.x, i / z_ / y_), at(box_.min.y, i / z_ % y_), at(box_.min.z, i % z_)};
  }
  BrickState of(BrickCoord b) const noexcept {
    const auto step = [](std::int32_t at, std::int32_t min) {
      return static_cast<std::size_t>(at - min);
    };
    return state_[(step(b.x, box_.min.x) * y_ + step(b.y, box_.min.y)) * z_ +
                  step(b.z, box_.min.z)];
  }
  std::uint64_t bytes() const noexcept { return heap_bytes(state_); }

 private:
  BrickBox box_;
  std::size_t y_ = 0, z_ = 0;
  std::vector<BrickState> state_;
};

}  // namespace tet
