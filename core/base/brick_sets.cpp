#include "core/base/brick_sets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

namespace tet {

namespace {

/// Fewer are sorted sooner by comparing them.
constexpr std::size_t kFewBricks = 512;

/// Bricks as numbers of the same order: their places in the box around all, axis after axis.
class BrickKeys {
 public:
  explicit BrickKeys(const std::vector<BrickCoord>& bricks) : min_(bricks[0]) {
    BrickCoord max = bricks[0];
    for (const BrickCoord b : bricks) {
      min_ = {std::min(min_.x, b.x), std::min(min_.y, b.y), std::min(min_.z, b.z)};
      max = {std::max(max.x, b.x), std::max(max.y, b.y), std::max(max.z, b.z)};
    }
    x_bits_ = bits(min_.x, max.x);
    y_bits_ = bits(min_.y, max.y);
    z_bits_ = bits(min_.z, max.z);
  }

  int bits() const noexcept { return x_bits_ + y_bits_ + z_bits_; }

  std::uint64_t key(BrickCoord b) const noexcept {
    return (distance(min_.x, b.x) << y_bits_ | distance(min_.y, b.y)) << z_bits_ |
           distance(min_.z, b.z);
  }

  BrickCoord brick(std::uint64_t key) const noexcept {
    const auto take = [&](std::int32_t min, int count) {
      const std::uint64_t low = key & ((std::uint64_t{1} << count) - 1);
      key >>= count;
      return static_cast<std::int32_t>(min + static_cast<std::int64_t>(low));
    };
    const std::int32_t z = take(min_.z, z_bits_), y = take(min_.y, y_bits_);
    return {take(min_.x, x_bits_), y, z};
  }

 private:
  static std::uint64_t distance(std::int32_t from, std::int32_t to) noexcept {
    return static_cast<std::uint64_t>(std::int64_t{to} - from);
  }
  static int bits(std::int32_t min, std::int32_t max) noexcept {
    return static_cast<int>(std::bit_width(distance(min, max)));
  }

  BrickCoord min_;
  int x_bits_, y_bits_, z_bits_;
};

/// Radix sort, from the lowest digit up.
void sort_keys(std::vector<std::uint64_t>& keys, int bits) {
  constexpr int kDigitBits = 11;
  constexpr std::uint64_t kDigitMask = (1U << kDigitBits) - 1;
  std::vector<std::uint64_t> sorted(keys.size());
  for (int shift = 0; shift < bits; shift += kDigitBits) {
    std::array<std::size_t, kDigitMask + 1> place{};
    for (const std::uint64_t key : keys) ++place[key >> shift & kDigitMask];
    std::size_t before = 0;
    for (std::size_t& count : place) before += std::exchange(count, before);
    for (const std::uint64_t key : keys) sorted[place[key >> shift & kDigitMask]++] = key;
    keys.swap(sorted);
  }
}

bool sorts_by_keys(std::vector<BrickCoord>& bricks) {
  constexpr int kMostBits = 63;
  const BrickKeys numbers(bricks);
  if (numbers.bits() > kMostBits) return false;
  std::vector<std::uint64_t> keys(bricks.size());
  std::ranges::transform(bricks, keys.begin(), [&](BrickCoord b) { return numbers.key(b); });
  sort_keys(keys, numbers.bits());
  std::ranges::transform(keys, bricks.begin(),
                         [&](std::uint64_t key) { return numbers.brick(key); });
  return true;
}

/// Sorted bricks with those one step before and behind: a step changes no order.
std::vector<BrickCoord> with_steps(const std::vector<BrickCoord>& bricks, BrickCoord step) {
  const auto moved = [&](int by) {
    std::vector<BrickCoord> out(bricks);
    for (BrickCoord& b : out) b = {b.x + by * step.x, b.y + by * step.y, b.z + by * step.z};
    return out;
  };
  std::vector<BrickCoord> before, all;
  std::ranges::set_union(moved(-1), bricks, std::back_inserter(before));
  std::ranges::set_union(before, moved(1), std::back_inserter(all));
  return all;
}

}  // namespace

void sort_unique(std::vector<BrickCoord>& bricks) {
  if (!std::ranges::is_sorted(bricks) &&
      (bricks.size() < kFewBricks || !sorts_by_keys(bricks))) {
    std::ranges::sort(bricks);
  }
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
}

std::vector<BrickCoord> with_neighbours(const std::vector<BrickCoord>& bricks, int step) {
  const auto along_z = with_steps(bricks, {0, 0, step});
  return with_steps(with_steps(along_z, {0, step, 0}), {step, 0, 0});
}

}  // namespace tet
