#include "core/mesh/box_tree.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace tet {
namespace {

/// Boxes of very different sizes, some of them points, many in one place.
std::vector<WorldBox> random_boxes(std::size_t count, std::uint32_t seed, double offset) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-10, 10), octave(-12, 2);
  std::vector<WorldBox> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const bool crowded = i % 3 == 0;
    const double size = i % 7 == 0 ? 0 : std::exp2(octave(random));
    const auto at = [&] { return offset + (crowded ? 1e-3 * place(random) : place(random)); };
    const WorldPoint min{at(), at(), at()};
    boxes.push_back({min, {min.x + size, min.y + size / 2, min.z + size}});
  }
  return boxes;
}

bool touch(const WorldBox& a, const WorldBox& b) {
  return a.min.x <= b.max.x && a.max.x >= b.min.x && a.min.y <= b.max.y && a.max.y >= b.min.y &&
         a.min.z <= b.max.z && a.max.z >= b.min.z;
}

double squared_distance_to(const WorldBox& box, const WorldPoint& p) {
  const auto off = [](double low, double high, double at) {
    return std::max({low - at, at - high, 0.0});
  };
  const double x = off(box.min.x, box.max.x, p.x), y = off(box.min.y, box.max.y, p.y),
               z = off(box.min.z, box.max.z, p.z);
  return x * x + y * y + z * z;
}

TEST(BoxTree, FindsEveryBoxThatTouches) {
  for (const std::size_t count : {1UL, 7UL, 8UL, 9UL, 64UL, 65UL, 3000UL}) {
    for (const double offset : {0.0, 1e6}) {
      const std::vector<WorldBox> boxes = random_boxes(count, 3, offset);
      const BoxTree tree(boxes);
      for (const WorldBox& asked : random_boxes(50, 4, offset)) {
        std::set<std::uint32_t> found;
        tree.visit_touching(asked, [&](std::uint32_t box) {
          EXPECT_TRUE(found.insert(box).second) << "twice";
          return true;
        });
        for (std::uint32_t i = 0; i < count; ++i) {
          EXPECT_TRUE(found.contains(i) || !touch(boxes[i], asked)) << i << " of " << count;
        }
      }
    }
  }
}

TEST(BoxTree, StopsWhenItIsTold) {
  const std::vector<WorldBox> boxes(100, WorldBox{{0, 0, 0}, {1, 1, 1}});
  int visited = 0;
  BoxTree(boxes).visit_touching({{0, 0, 0}, {1, 1, 1}},
                                [&](std::uint32_t) { return ++visited < 3; });
  EXPECT_EQ(visited, 3);
}

TEST(BoxTree, FindsTheNearestBox) {
  for (const std::size_t count : {1UL, 9UL, 3000UL}) {
    const std::vector<WorldBox> boxes = random_boxes(count, 5, 0);
    const BoxTree tree(boxes);
    for (const WorldBox& from : random_boxes(50, 6, 3)) {
      double least = 1e300;
      for (const WorldBox& box : boxes)
        least = std::min(least, squared_distance_to(box, from.min));
      const BoxTree::Nearest found = tree.nearest(
          from.min, [&](std::uint32_t i) { return squared_distance_to(boxes[i], from.min); });
      EXPECT_EQ(found.squared_distance, least);
      EXPECT_EQ(squared_distance_to(boxes[found.box], from.min), least);
    }
  }
}

TEST(BoxTree, WithoutBoxesFindsNothing) {
  const BoxTree tree;
  tree.visit_touching({{0, 0, 0}, {1, 1, 1}}, [](std::uint32_t) {
    ADD_FAILURE();
    return true;
  });
  EXPECT_EQ(tree.nearest({}, [](std::uint32_t) { return 0.0; }).squared_distance, HUGE_VAL);
}

}  // namespace
}  // namespace tet
