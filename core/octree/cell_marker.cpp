#include "core/octree/cell_marker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

namespace tet {
namespace {

/// Cells `first` to `end` of a level, the last excluded, along each axis.
LatticeSpan span_of(const std::array<double, 3>& first,
                    const std::array<double, 3>& end,
                    int level) {
  LatticeSpan span;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    span.centre[axis] = std::ldexp((first[axis] + end[axis]) / 2, level);
    span.half[axis] = std::ldexp((end[axis] - first[axis]) / 2, level);
  }
  return span;
}

LatticeSpan span_of(const BrickBox& bricks, int level) {
  const auto& [min, max] = bricks;
  return span_of({8.0 * min.x, 8.0 * min.y, 8.0 * min.z},
                 {8.0 * max.x + 8, 8.0 * max.y + 8, 8.0 * max.z + 8}, level);
}

/// The finest bricks that a span touches, within index space.
BrickBox bricks_of(const VoxelSpan& span) {
  const auto brick = [](double at) {
    constexpr double kMost = kMaxVoxelCoord;
    return static_cast<std::int32_t>(std::floor(std::clamp(at, -kMost, kMost) / kBrickEdge));
  };
  return {{brick(span.min.x), brick(span.min.y), brick(span.min.z)},
          {brick(span.max.x), brick(span.max.y), brick(span.max.z)}};
}

/// What two boxes have in common, in bricks of a higher level.
std::optional<BrickBox> common(const BrickBox& a, const BrickBox& b, int level) {
  const BrickBox both{
      {std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
      {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
  const auto& [min, max] = both;
  if (min.x > max.x || min.y > max.y || min.z > max.z) return std::nullopt;
  return BrickBox{{min.x >> level, min.y >> level, min.z >> level},
                  {max.x >> level, max.y >> level, max.z >> level}};
}

/// Makes one box of those that follow each other along z.
std::vector<BrickBox> joined_along_z(std::vector<BrickBox> boxes) {
  const auto column = [](const BrickBox& b) {
    return std::tuple(b.min.x, b.min.y, b.max.x, b.max.y);
  };
  std::ranges::sort(boxes, {}, [&](const BrickBox& b) {
    return std::tuple_cat(column(b), std::tuple(b.min.z));
  });
  std::vector<BrickBox> joined;
  for (const BrickBox& box : boxes) {
    if (!joined.empty() && column(joined.back()) == column(box) &&
        box.min.z <= joined.back().max.z + 1) {
      joined.back().max.z = std::max(joined.back().max.z, box.max.z);
    } else {
      joined.push_back(box);
    }
  }
  return joined;
}

/// The two halves of a box along its longest edge.
std::pair<BrickBox, BrickBox> halves(const BrickBox& box) {
  BrickBox low = box, high = box;
  const std::int64_t x = std::int64_t{box.max.x} - box.min.x,
                     y = std::int64_t{box.max.y} - box.min.y,
                     z = std::int64_t{box.max.z} - box.min.z;
  const auto along = x >= y && x >= z ? &BrickCoord::x
                     : y >= z         ? &BrickCoord::y
                                      : &BrickCoord::z;
  low.max.*along =
      static_cast<std::int32_t>((std::int64_t{box.min.*along} + box.max.*along) >> 1);
  high.min.*along = low.max.*along + 1;
  return {low, high};
}

}  // namespace

void CellMarker::mark(const std::vector<BrickBox>& cover) {
  const BrickBox bounds = bricks_of(shape_.bounds());
  std::vector<BrickBox> boxes;
  for (const BrickBox& box : cover) {
    if (const auto part = common(box, bounds, level_)) boxes.push_back(*part);
  }
  for (const BrickBox& box : joined_along_z(std::move(boxes))) mark(box);
}

void CellMarker::mark(const BrickBox& bricks) {
  if (marked_ > most_ || cancellation_.requested()) return;
  const Reach reach = shape_.reach(span_of(bricks, level_));
  if (reach == Reach::kNone) return;
  if (reach == Reach::kAll) return mark_all(bricks);
  if (bricks.min == bricks.max) return mark_part(bricks.min);
  const auto [low, high] = halves(bricks);
  mark(low);
  mark(high);
}

void CellMarker::mark_all(const BrickBox& bricks) {
  marked_ += kBrickCells * bricks_in(bricks);
  if (marked_ > most_) return;
  for_each_brick(bricks, [&](BrickCoord brick) { cells_.add(brick, BrickMask::all()); });
}

void CellMarker::mark_part(BrickCoord brick) {
  BrickMask mask;
  for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
    const std::array<double, 3> first{8.0 * brick.x + x, 8.0 * brick.y + y, 8.0 * brick.z + z};
    const LatticeSpan cell = span_of(first, {first[0] + 1, first[1] + 1, first[2] + 1}, level_);
    if (shape_.reach(cell) != Reach::kNone) mask.set(x, y, z);
  });
  if (mask.any()) cells_.add(brick, mask);
  marked_ += mask.count();
}

}  // namespace tet
