// A mask for each of many bricks, of which most are empty or full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/brick_index.h"
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

  /// Appends `count` masks of another column, from `begin` on.
  void append_run(const MaskColumn& from, std::size_t begin, std::size_t count) {
    // Masks that are neither empty nor full lie in the order of their bricks.
    if (masks_.empty()) masks_ = {BrickMask{}, BrickMask::all()};
    std::uint32_t first = 0, end = 0;  // of those masks in the other column; none yet
    for (std::size_t i = begin; i < begin + count; ++i) {
      const std::uint32_t at = from.at_[i];
      if (at <= kFull) {
        at_.push_back(at);
        continue;
      }
      if (end == 0) first = at;
      end = at + 1;
      at_.push_back(static_cast<std::uint32_t>(masks_.size()) + (at - first));
    }
    masks_.insert(masks_.end(), from.masks_.begin() + first, from.masks_.begin() + end);
  }

  /// Appends a mask for each of `places`: that of `known` there, or, where a place is kNoBrick,
  /// the next of `found`. Places that follow each other are copied in runs.
  void append(const MaskColumn& known,
              std::span<const std::uint32_t> places,
              std::span<const BrickMask> found) {
    for (std::size_t i = 0, next = 0; i < places.size();) {
      if (places[i] == kNoBrick) {
        push_back(found[next++]);
        ++i;
        continue;
      }
      const std::size_t first = i;
      for (++i; i < places.size() && places[i] == places[i - 1] + 1;) ++i;
      append_run(known, places[first], i - first);
    }
  }

  std::uint64_t bytes() const noexcept { return all_heap_bytes(at_, masks_); }

 private:
  static constexpr std::uint32_t kEmpty = 0, kFull = 1;

  std::vector<std::uint32_t> at_;  // of each brick, in masks_
  std::vector<BrickMask> masks_;   // an empty one, a full one, and the others
};

}  // namespace tet
