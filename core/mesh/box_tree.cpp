#include "core/mesh/box_tree.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/space_curve.h"

namespace tet {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kBoxesPerRange = 4096;

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
  order_ = order_along_curve(boxes.size(), all, [&](std::size_t i) {
    const auto& [min, max] = boxes[i];
    return WorldPoint{min.x / 2 + max.x / 2, min.y / 2 + max.y / 2, min.z / 2 + max.z / 2};
  });

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
        float low = kInfinity, high = -kInfinity;
        if (child < count) {
          low = *std::ranges::min_element(below[child].min[axis]);
          high = *std::ranges::max_element(below[child].max[axis]);
        }
        nodes[n].min[axis][i] = low;
        nodes[n].max[axis][i] = high;
      }
    }
  }
  levels_.push_back(std::move(nodes));
}

}  // namespace tet
