#include "core/base/brick_sets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
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

/// Calls `body` with pieces of `items`, one after the other. False once cancelled.
template <class T, class Body>
bool for_each_piece(std::span<T> items, const Cancellation& cancellation, const Body& body) {
  while (!items.empty()) {
    if (cancellation.requested()) return false;
    const std::span<T> piece = items.first(std::min(kBricksPerLook, items.size()));
    body(piece);
    items = items.subspan(piece.size());
  }
  return true;
}

/// Radix sort, from the lowest digit up. False once cancelled.
bool sort_keys(std::vector<std::uint64_t>& keys, int bits, const Cancellation& cancellation) {
  constexpr int kDigitBits = 11;
  constexpr std::uint64_t kDigitMask = (1U << kDigitBits) - 1;
  std::vector<std::uint64_t> sorted(keys.size());
  for (int shift = 0; shift < bits; shift += kDigitBits) {
    std::array<std::size_t, kDigitMask + 1> place{};
    const auto each = [&](const auto& body) {
      return for_each_piece(std::span<const std::uint64_t>(keys), cancellation,
                            [&](std::span<const std::uint64_t> piece) {
                              for (const std::uint64_t key : piece) body(key);
                            });
    };
    if (!each([&](std::uint64_t key) { ++place[key >> shift & kDigitMask]; })) return false;
    std::size_t before = 0;
    for (std::size_t& count : place) before += std::exchange(count, before);
    const auto move = [&](std::uint64_t key) {
      sorted[place[key >> shift & kDigitMask]++] = key;
    };
    if (!each(move)) return false;
    keys.swap(sorted);
  }
  return true;
}

void sort_by_keys(const BrickKeys& numbers,
                  const Cancellation& cancellation,
                  std::vector<BrickCoord>& bricks) {
  std::vector<std::uint64_t> keys;
  keys.reserve(bricks.size());
  const bool made = for_each_piece(std::span<const BrickCoord>(bricks), cancellation,
                                   [&](std::span<const BrickCoord> piece) {
                                     for (const BrickCoord b : piece)
                                       keys.push_back(numbers.key(b));
                                   });
  if (!made || !sort_keys(keys, numbers.bits(), cancellation)) return;
  auto to = bricks.begin();
  for_each_piece(std::span<const std::uint64_t>(keys), cancellation,
                 [&](std::span<const std::uint64_t> piece) {
                   for (const std::uint64_t key : piece) *to++ = numbers.brick(key);
                 });
}

/// Merges two sorted runs onto the end of `merged`. False once cancelled.
bool merge_runs(std::span<const BrickCoord> a,
                std::span<const BrickCoord> b,
                const Cancellation& cancellation,
                std::vector<BrickCoord>& merged) {
  while (!a.empty() || !b.empty()) {
    if (cancellation.requested()) return false;
    for (std::size_t i = 0; i < kBricksPerLook && !(a.empty() && b.empty()); ++i) {
      std::span<const BrickCoord>& from = a.empty() || (!b.empty() && b[0] < a[0]) ? b : a;
      merged.push_back(from[0]);
      from = from.subspan(1);
    }
  }
  return true;
}

/// Sorts by comparing: bricks so far apart that no number tells them from each other.
void sort_by_merging(const Cancellation& cancellation, std::vector<BrickCoord>& bricks) {
  for_each_piece(std::span<BrickCoord>(bricks), cancellation,
                 [](std::span<BrickCoord> piece) { std::ranges::sort(piece); });
  for (std::size_t run = kBricksPerLook; run < bricks.size(); run *= 2) {
    std::vector<BrickCoord> merged;
    merged.reserve(bricks.size());
    for (std::size_t first = 0; first < bricks.size(); first += 2 * run) {
      const auto rest = std::span<const BrickCoord>(bricks).subspan(first);
      const auto a = rest.first(std::min(run, rest.size()));
      const auto after = rest.subspan(a.size());
      const auto b = after.first(std::min(run, after.size()));
      if (!merge_runs(a, b, cancellation, merged)) return;
    }
    bricks.swap(merged);
  }
}

void sort_bricks(const Cancellation& cancellation, std::vector<BrickCoord>& bricks) {
  constexpr int kMostBits = 63;
  if (bricks.size() < kFewBricks) {
    std::ranges::sort(bricks);
    return;
  }
  const BrickKeys numbers(bricks);
  if (numbers.bits() <= kMostBits) {
    sort_by_keys(numbers, cancellation, bricks);
  } else {
    sort_by_merging(cancellation, bricks);
  }
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

void sort_unique(std::vector<BrickCoord>& bricks, const Cancellation& cancellation) {
  if (!std::ranges::is_sorted(bricks)) sort_bricks(cancellation, bricks);
  if (cancellation.requested()) return;
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
}

std::vector<BrickCoord> with_neighbours(const std::vector<BrickCoord>& bricks,
                                        int step,
                                        std::size_t most) {
  std::vector<BrickCoord> all = bricks;
  for (const BrickCoord along :
       {BrickCoord{0, 0, step}, BrickCoord{0, step, 0}, BrickCoord{step, 0, 0}}) {
    if (all.size() > most) break;
    all = with_steps(all, along);
  }
  return all;
}

}  // namespace tet
