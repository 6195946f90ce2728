#include "core/mesh/box_tree.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kBitsPerAxis = 21;
constexpr std::size_t kBoxesPerRange = 4096;

/// Puts two zeros between the bits of a number of 21.
std::uint64_t spread(std::uint64_t n) noexcept {
  n = (n | n << 32) & 0x1f00000000ffffULL;
  n = (n | n << 16) & 0x1f0000ff0000ffULL;
  n = (n | n << 8) & 0x100f00f00f00f00fULL;
  n = (n | n << 4) & 0x10c30c30c30c30c3ULL;
  return (n | n << 2) & 0x1249249249249249ULL;
}

WorldBox around(std::span<const WorldBox> boxes) noexcept {
  WorldBox all = boxes.front();
  for (const auto& [min, max] : boxes) {
    all.min = {std::min(all.min.x, min.x), std::min(all.min.y, min.y),
               std::min(all.min.z, min.z)};
    all.max = {std::max(all.max.x, max.x), std::max(all.max.y, max.y),
               std::max(all.max.z, max.z)};
  }
  return all;
}

/// A place along the curve.
struct Key {
  std::uint64_t code = 0;
  std::uint32_t box = 0;
};

std::vector<Key> keys_of(std::span<const WorldBox> boxes, const WorldBox& all) {
  constexpr double kSteps = (1 << kBitsPerAxis) - 1;
  const auto place = [&](double low, double high, double min, double max) {
    const double share = max > min ? (low / 2 + high / 2 - min) / (max - min) : 0;
    return spread(static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * kSteps));
  };
  std::vector<Key> keys(boxes.size());
  for_each_index(
      boxes.size(),
      [&](std::size_t i) {
        const auto& [min, max] = boxes[i];
        keys[i] = {place(min.x, max.x, all.min.x, all.max.x) << 2 |
                       place(min.y, max.y, all.min.y, all.max.y) << 1 |
                       place(min.z, max.z, all.min.z, all.max.z),
                   static_cast<std::uint32_t>(i)};
      },
      kBoxesPerRange);
  return keys;
}

/// Digit by digit from the lowest: count, then fill; equal keys stay in order.
void sort_keys(std::vector<Key>& keys) {
  constexpr int kDigitBits = 11;
  constexpr std::uint64_t kDigits = std::uint64_t{1} << kDigitBits;
  std::vector<Key> sorted(keys.size());
  for (int shift = 0; shift < 3 * kBitsPerAxis; shift += kDigitBits) {
    const auto digit = [&](const Key& key) { return key.code >> shift & (kDigits - 1); };
    std::array<std::uint64_t, kDigits> next{};
    for (const Key& key : keys) ++next[digit(key)];
    std::uint64_t first = 0;
    for (std::uint64_t& count : next) first += std::exchange(count, first);
    for (const Key& key : keys) sorted[next[digit(key)]++] = key;
    keys.swap(sorted);
  }
}

}  // namespace

BoxTree::BoxTree(std::span<const WorldBox> boxes) {
  if (boxes.empty()) return;
  sort_boxes(boxes);
  for (std::size_t nodes = levels_.back().size(); nodes > 1; nodes = levels_.back().size()) {
    add_level(nodes);
  }
}

void BoxTree::sort_boxes(std::span<const WorldBox> boxes) {
  const WorldBox all = around(boxes);
  middle_ = {all.min.x / 2 + all.max.x / 2, all.min.y / 2 + all.max.y / 2,
             all.min.z / 2 + all.max.z / 2};
  std::vector<Key> keys = keys_of(boxes, all);
  sort_keys(keys);
  order_.resize(keys.size());
  std::ranges::transform(keys, order_.begin(), [](const Key& key) { return key.box; });

  std::vector<Node>& leaves = levels_.emplace_back((boxes.size() + kWidth - 1) / kWidth);
  const auto down = [](double v) { return std::nextafter(static_cast<float>(v), -kInfinity); };
  const auto up = [](double v) { return std::nextafter(static_cast<float>(v), kInfinity); };
  for_each_index(
      leaves.size(),
      [&](std::size_t n) {
        Node& node = leaves[n];
        for (std::size_t i = 0; i < kWidth; ++i) {
          const std::size_t at = n * kWidth + i;
          if (at >= order_.size()) {
            for (auto& column : node.min) column[i] = kInfinity;
            for (auto& column : node.max) column[i] = -kInfinity;
            continue;
          }
          const auto& [min, max] = boxes[order_[at]];
          node.min[0][i] = down(min.x - middle_.x);
          node.min[1][i] = down(min.y - middle_.y);
          node.min[2][i] = down(min.z - middle_.z);
          node.max[0][i] = up(max.x - middle_.x);
          node.max[1][i] = up(max.y - middle_.y);
          node.max[2][i] = up(max.z - middle_.z);
        }
      },
      kBoxesPerRange / kWidth);
}

/// Boxes around each of the last level's nodes.
void BoxTree::add_level(std::size_t count) {
  std::vector<Node> nodes((count + kWidth - 1) / kWidth);
  const std::vector<Node>& below = levels_.back();
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (std::size_t i = 0; i < kWidth; ++i) {
      const std::size_t child = n * kWidth + i;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool is_one = child < count;
        nodes[n].min[axis][i] =
            is_one ? *std::ranges::min_element(below[child].min[axis]) : kInfinity;
        nodes[n].max[axis][i] =
            is_one ? *std::ranges::max_element(below[child].max[axis]) : -kInfinity;
      }
    }
  }
  levels_.push_back(std::move(nodes));
}

}  // namespace tet
