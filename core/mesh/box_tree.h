// Boxes that can be looked up by where they are.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/sse.h"
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
  /// The boxes of a node, as bits, that touch what lies from `low` to `high`.
  static unsigned touching(const Node& node,
                           const std::array<float, 3>& low,
                           const std::array<float, 3>& high) noexcept;
  /// How far each box of a node is from a place, squared; and, as bits, which are nearer than
  /// `below`.
  static unsigned nearer(const Node& node,
                         const std::array<double, 3>& at,
                         double below,
                         std::array<double, kWidth>& squares) noexcept;

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

// Written out: compilers make branches of these loops, which go either way half the time.

inline unsigned BoxTree::touching(const Node& node,
                                  const std::array<float, 3>& low,
                                  const std::array<float, 3>& high) noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < kWidth; i += 4) {
    __m128 touches = _mm_cmple_ps(_mm_loadu_ps(&node.min[0][i]), _mm_set1_ps(high[0]));
    touches =
        _mm_and_ps(touches, _mm_cmpge_ps(_mm_loadu_ps(&node.max[0][i]), _mm_set1_ps(low[0])));
    for (std::size_t axis = 1; axis < 3; ++axis) {
      const __m128 begins =
          _mm_cmple_ps(_mm_loadu_ps(&node.min[axis][i]), _mm_set1_ps(high[axis]));
      const __m128 ends =
          _mm_cmpge_ps(_mm_loadu_ps(&node.max[axis][i]), _mm_set1_ps(low[axis]));
      touches = _mm_and_ps(touches, _mm_and_ps(begins, ends));
    }
    bits |= static_cast<unsigned>(_mm_movemask_ps(touches)) << i;
  }
  return bits;
}

inline unsigned BoxTree::nearer(const Node& node,
                                const std::array<double, 3>& at,
                                double below,
                                std::array<double, kWidth>& squares) noexcept {
  const auto pair_of = [](const float* numbers) {
    return _mm_cvtps_pd(_mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(numbers))));
  };
  unsigned bits = 0;
  for (std::size_t i = 0; i < kWidth; i += 2) {
    __m128d sum = _mm_setzero_pd();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const __m128d place = _mm_set1_pd(at[axis]);
      const __m128d below_min = _mm_sub_pd(pair_of(&node.min[axis][i]), place);
      const __m128d above_max = _mm_sub_pd(place, pair_of(&node.max[axis][i]));
      const __m128d outside = _mm_max_pd(_mm_max_pd(below_min, above_max), _mm_setzero_pd());
      sum = _mm_add_pd(sum, _mm_mul_pd(outside, outside));
    }
    _mm_storeu_pd(&squares[i], sum);
    const __m128d is_nearer = _mm_cmplt_pd(sum, _mm_set1_pd(below));
    bits |= static_cast<unsigned>(_mm_movemask_pd(is_nearer)) << i;
  }
  return bits;
}

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
    for (unsigned bits = touching(node, low, high); bits != 0; bits &= bits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(bits));
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
    std::array<double, kWidth> squares;
    for (unsigned bits = nearer(node, at, best.squared_distance, squares); bits != 0;
         bits &= bits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(bits));
      const double squared = squares[i];
      if (squared >= best.squared_distance) continue;  // what came before was nearer
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
