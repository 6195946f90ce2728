#include "core/surface/default_voxel.h"

#include <gtest/gtest.h>

#include "tests/support/surfaces.h"

namespace tet {
namespace {

TEST(DefaultVoxel, IsOfTheLongestExtent) {
  EXPECT_DOUBLE_EQ(default_voxel(test::box_surface({1, 2, 3}, {65, 34, 35})), 0.5);
}

TEST(DefaultVoxel, LeavesOutVerticesThatNoTriangleNames) {
  TriangleSurface box = test::box_surface({1, 2, 3}, {65, 34, 35});
  box.vertices.push_back({1e6, 0, 0});
  EXPECT_DOUBLE_EQ(default_voxel(box), 0.5);
}

}  // namespace
}  // namespace tet
