// Boxes that can be looked up by where they are.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// A tree over boxes of any sizes: they are sorted along a curve that fills space, and runs of
/// eight that follow each other have a box around them, runs of eight of these again, and so
/// on. A hostile set of boxes makes it slow at worst, never large.
///
/// Immutable: any thread may ask. What it says does not depend on threads.
class BoxTree {
 public:
  static constexpr std::size_t kWidth = 8;

  BoxTree() = default;
  /// Boxes are numbered in their order; all coordinates are finite. Parallel.
  explicit BoxTree(std::span<const WorldBox> boxes);

  std::size_t size() const noexcept { return order_.size(); }

  /// Calls `visit(box number)` for each box that touches `box`, and maybe for a few within
  /// rounding of it, in a fixed order. Ends at once when it returns false.
  template <class Visit>
  void visit_touching(const WorldBox& box, const Visit& visit) const;

  struct Nearest {
    std::uint32_t box = 0;
    double squared_distance = std::numeric_limits<double>::infinity();
  };
  /// The box whose content is the nearest to `p`, where `squared_distance(box number)` tells
  /// how far the content is, which lies in the box. Infinite where there is none, or none
  /// nearer than `below`.
  template <class SquaredDistance>
  Nearest nearest(const WorldPoint& p,
                  const SquaredDistance& squared_distance,
                  double below = std::numeric_limits<double>::infinity()) const;

 private:
  /// Eight boxes as columns, rounded outward, relative to `middle_`.
  struct Node {
    std::array<std::array<float, kWidth>, 3> min, max;
  };
  struct Place {
    std::uint32_t level = 0, node = 0;
  };
  /// Boxes number 2^32 at most, so there are eleven levels; of each a path leaves seven behind.
  using Path = std::array<Place, kWidth * 12>;

  void sort_boxes(std::span<const WorldBox> boxes);
  void add_level(std::size_t count);

  WorldPoint middle_{};
  std::vector<std::uint32_t> order_;       // of the boxes along the curve
  std::vector<std::vector<Node>> levels_;  // the boxes themselves, then boxes around nodes
};

template <class Visit>
void BoxTree::visit_touching(const WorldBox& box, const Visit& visit) const {
  if (levels_.empty()) return;
  const auto down = [](double v) {
    return std::nextafter(static_cast<float>(v), -std::numeric_limits<float>::infinity());
  };
  const auto up = [](double v) {
    return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
  };
  const std::array<float, 3> low{down(box.min.x - middle_.x), down(box.min.y - middle_.y),
                                 down(box.min.z - middle_.z)};
  const std::array<float, 3> high{up(box.max.x - middle_.x), up(box.max.y - middle_.y),
                                  up(box.max.z - middle_.z)};
  Path path;
  std::size_t depth = 0;
  path[depth++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
  while (depth > 0) {
    const Place at = path[--depth];
    const Node& node = levels_[at.level][at.node];
    // Without branches, so that compilers make vector instructions of it.
    std::array<int, kWidth> touches;
    touches.fill(1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < kWidth; ++i) {
        touches[i] &= static_cast<int>(node.min[axis][i] <= high[axis]) &
                      static_cast<int>(node.max[axis][i] >= low[axis]);
      }
    }
    for (std::size_t i = 0; i < kWidth; ++i) {
      if (touches[i] == 0) continue;
      const auto child = static_cast<std::uint32_t>(at.node * kWidth + i);
      if (at.level > 0) {
        path[depth++] = {at.level - 1, child};
      } else if (!visit(order_[child])) {
        return;
      }
    }
  }
}

template <class SquaredDistance>
BoxTree::Nearest BoxTree::nearest(const WorldPoint& p,
                                  const SquaredDistance& squared_distance,
                                  double below) const {
  Nearest best{0, below};
  bool found = false;
  struct Step {
    Place place;
    double squared = 0;  ///< nothing in the node is nearer
  };
  std::array<Step, kWidth * 12> path;
  std::size_t depth = 0;
  if (!levels_.empty()) path[depth++] = {{static_cast<std::uint32_t>(levels_.size() - 1), 0}};
  const std::array<double, 3> at{p.x - middle_.x, p.y - middle_.y, p.z - middle_.z};
  while (depth > 0) {
    const Step step = path[--depth];
    if (step.squared >= best.squared_distance) continue;
    const Node& node = levels_[step.place.level][step.place.node];
    const std::size_t first = depth;
    // Without branches, so that compilers make vector instructions of it.
    std::array<double, kWidth> squares{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < kWidth; ++i) {
        const double below_min = static_cast<double>(node.min[axis][i]) - at[axis];
        const double above_max = at[axis] - static_cast<double>(node.max[axis][i]);
        const double off = below_min > above_max ? below_min : above_max;
        const double outside = off > 0 ? off : 0;
        squares[i] += outside * outside;
      }
    }
    for (std::size_t i = 0; i < kWidth; ++i) {
      const double squared = squares[i];
      if (squared >= best.squared_distance) continue;  // nor is there one, where it is infinite
      const auto child = static_cast<std::uint32_t>(step.place.node * kWidth + i);
      if (step.place.level == 0) {
        const double exact = squared_distance(order_[child]);
        if (exact < best.squared_distance) {
          best = {order_[child], exact};
          found = true;
        }
        continue;
      }
      // The nearest is looked at first: it lies last.
      std::size_t place = depth++;
      for (; place > first && path[place - 1].squared < squared; --place) {
        path[place] = path[place - 1];
      }
      path[place] = {{step.place.level - 1, child}, squared};
    }
  }
  return found ? best : Nearest{};
}

}  // namespace tet
