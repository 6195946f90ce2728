// Masks of OpenVDB's tree nodes: a bit for each child, as the file has them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/base/types.h"

namespace tet {

/// The bits of a node with 2^kLog2 children along each axis, that of (x, y, z) at
/// (x * 2^kLog2 + y) * 2^kLog2 + z.
template <int kLog2>
struct NodeMask {
  static constexpr std::size_t kBits = std::size_t{1} << (3 * kLog2);
  static constexpr std::size_t kBytes = kBits / 8;
  static constexpr std::size_t kWords = kBits / 64;

  std::array<std::uint64_t, kWords> words{};

  static NodeMask from_bytes(const std::byte* bytes) noexcept {
    NodeMask mask;
    std::memcpy(mask.words.data(), bytes, kBytes);
    return mask;
  }

  std::uint32_t count() const noexcept {
    std::uint32_t bits = 0;
    for (const std::uint64_t word : words) {
      bits += static_cast<std::uint32_t>(std::popcount(word));
    }
    return bits;
  }

  friend NodeMask operator|(NodeMask a, const NodeMask& b) noexcept {
    for (std::size_t i = 0; i < kWords; ++i) a.words[i] |= b.words[i];
    return a;
  }
  friend NodeMask operator&(NodeMask a, const NodeMask& b) noexcept {
    for (std::size_t i = 0; i < kWords; ++i) a.words[i] &= b.words[i];
    return a;
  }
  friend NodeMask operator~(NodeMask a) noexcept {
    for (std::uint64_t& word : a.words) word = ~word;
    return a;
  }

  static VoxelCoord place(std::size_t bit) noexcept {
    constexpr std::size_t kMask = (std::size_t{1} << kLog2) - 1;
    return {static_cast<std::int32_t>(bit >> (2 * kLog2)),
            static_cast<std::int32_t>((bit >> kLog2) & kMask),
            static_cast<std::int32_t>(bit & kMask)};
  }

  /// Calls `visit(bit)` for each bit that is set, in order.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < kWords; ++i) {
      for (std::uint64_t rest = words[i]; rest != 0; rest &= rest - 1) {
        visit(i * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
      }
    }
  }

  /// Around the set bits, in children.
  VoxelBox box() const noexcept;
};

template <int kLog2>
VoxelBox NodeMask<kLog2>::box() const noexcept {
  // A slice of equal x is whole words; those of all slices are laid upon each other.
  constexpr std::size_t kSliceWords = kWords >> kLog2;
  std::array<std::uint64_t, kSliceWords> slices{};
  VoxelBox box{{1 << kLog2, 1 << kLog2, 1 << kLog2}, {0, 0, 0}};
  for (std::size_t i = 0; i < kWords; ++i) {
    if (words[i] == 0) continue;
    const auto x = static_cast<std::int32_t>(i / kSliceWords);
    box.min.x = std::min(box.min.x, x);
    box.max.x = std::max(box.max.x, x);
    slices[i % kSliceWords] |= words[i];
  }
  constexpr int kRow = 1 << kLog2;
  std::uint64_t row = 0;
  for (int bit = 0; bit < kRow * kRow; bit += kRow) {
    const auto at = static_cast<std::size_t>(bit);
    const std::uint64_t z = slices[at / 64] >> (at % 64) & (~std::uint64_t{0} >> (64 - kRow));
    if (z == 0) continue;
    row |= z;
    box.min.y = std::min(box.min.y, bit / kRow);
    box.max.y = std::max(box.max.y, bit / kRow);
  }
  if (row == 0) return {};
  box.min.z = std::countr_zero(row);
  box.max.z = 63 - std::countl_zero(row);
  return box;
}

using LeafMask = NodeMask<3>;
using LowerMask = NodeMask<4>;
using UpperMask = NodeMask<5>;

}  // namespace tet
