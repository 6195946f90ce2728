// A mask for each of many bricks, of which most are empty or full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/heap_bytes.h"

namespace tet {

/// A column of masks. Those that are empty or full, as nearly all are deep inside, take four
/// bytes, not 64.
class MaskColumn {
 public:
  MaskColumn() noexcept = default;
  explicit MaskColumn(std::span<const BrickMask> masks) {
    reserve(masks.size());
    for (const BrickMask& mask : masks) push_back(mask);
  }

  /// So many full masks.
  static MaskColumn full(std::size_t count) {
    MaskColumn column;
    column.masks_ = {BrickMask{}, BrickMask::all()};
    column.at_.assign(count, kFull);
    return column;
  }

  bool empty() const noexcept { return at_.empty(); }
  std::size_t size() const noexcept { return at_.size(); }
  /// Valid until a mask is added.
  const BrickMask& operator[](std::size_t i) const noexcept { return masks_[at_[i]]; }

  void reserve(std::size_t count) { at_.reserve(count); }
  void push_back(const BrickMask& mask) {
    if (masks_.empty()) masks_ = {BrickMask{}, BrickMask::all()};
    if (mask == masks_[kEmpty]) {
      at_.push_back(kEmpty);
    } else if (mask == masks_[kFull]) {
      at_.push_back(kFull);
    } else {
      at_.push_back(static_cast<std::uint32_t>(masks_.size()));
      masks_.push_back(mask);
    }
  }

  std::uint64_t bytes() const noexcept { return all_heap_bytes(at_, masks_); }

 private:
  static constexpr std::uint32_t kEmpty = 0, kFull = 1;

  std::vector<std::uint32_t> at_;  // of each brick, in masks_
  std::vector<BrickMask> masks_;   // an empty one, a full one, and the others
};

}  // namespace tet
