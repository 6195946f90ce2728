#include "core/base/brick_index.h"

#include <bit>
#include <cstddef>

namespace tet {
namespace {

std::size_t hash_of(BrickCoord brick) noexcept {
  // Odd constants spread neighbours apart; the multiply's high half mixes them.
  const auto word = [](std::int32_t v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v));
  };
  std::uint64_t h = word(brick.x) * 0x9e3779b97f4a7c15U;
  h = (h ^ h >> 32) + word(brick.y) * 0xc2b2ae3d27d4eb4fU;
  h = (h ^ h >> 29) + word(brick.z) * 0x165667b19e3779f9U;
  h = (h ^ h >> 32) * 0x9e3779b97f4a7c15U;
  return static_cast<std::size_t>(h >> 16);
}

}  // namespace

BrickIndex::BrickIndex(std::span<const BrickCoord> bricks)
    : bricks_(bricks), slots_(std::bit_ceil(bricks.size() * 2 + 1), kNoBrick) {
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    std::size_t slot = hash_of(bricks[i]) & mask;
    while (slots_[slot] != kNoBrick) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<std::uint32_t>(i);
  }
}

std::uint32_t BrickIndex::find(BrickCoord brick) const noexcept {
  if (bricks_.empty()) return kNoBrick;
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t slot = hash_of(brick) & mask;; slot = (slot + 1) & mask) {
    const std::uint32_t found = slots_[slot];
    if (found == kNoBrick || bricks_[found] == brick) return found;
  }
}

}  // namespace tet
