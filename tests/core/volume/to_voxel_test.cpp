#include "core/volume/to_voxel.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/volume/check_transform.h"
#include "tests/support/nearly_cubic.h"

namespace tet {
namespace {

VoxelTransform of_columns(const std::array<std::array<double, 3>, 3>& linear) {
  VoxelTransform transform;
  transform.linear = linear;
  transform.translation = {0.25, -7, 1000};
  transform.voxel_size = voxel_edge(transform);
  return transform;
}

/// A rotation by 0.7 about an axis that lies along none, times 0.03.
VoxelTransform rotation() {
  const double c = std::cos(0.7), s = std::sin(0.7), d = 1 - c, size = 0.03;
  const double x = 2.0 / 7, y = 3.0 / 7, z = 6.0 / 7;
  std::array<std::array<double, 3>, 3> m{
      {{c + x * x * d, x * y * d - z * s, x * z * d + y * s},
       {x * y * d + z * s, c + y * y * d, y * z * d - x * s},
       {x * z * d - y * s, y * z * d + x * s, c + z * z * d}}};
  for (auto& row : m) {
    for (double& entry : row) entry *= size;
  }
  return of_columns(m);
}

/// Its edge is told by a number that is off by as much as is taken for rounding.
VoxelTransform with_rounded_size() {
  VoxelTransform transform = of_columns({{{0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}}});
  transform.voxel_size = 0.100006;
  return transform;
}

TEST(ToVoxel, LeadsBackFromFarAwayWhateverTheVoxels) {
  for (const VoxelTransform& transform :
       {VoxelTransform{}, rotation(), with_rounded_size(), test::nearly_cubic(),
        of_columns({{{0.5, 0.2, 0}, {-0.1, 0.6, 0.3}, {0, 0, -1.5}}})}) {
    ASSERT_TRUE(check_transform(transform).ok()) << check_transform(transform);
    const VoxelPoint there{-40000, 10000.5, 30000};
    const VoxelPoint back = to_voxel(transform, transform.to_world(there));
    EXPECT_NEAR(back.x, there.x, 1e-6);
    EXPECT_NEAR(back.y, there.y, 1e-6);
    EXPECT_NEAR(back.z, there.z, 1e-6);
  }
}

// Meshes of turned grids keep their bytes.
TEST(ToVoxel, TakesTheTransposeOfARotation) {
  for (const VoxelTransform& transform : {VoxelTransform{}, rotation()}) {
    EXPECT_TRUE(is_scaled_rotation(transform));
    const InverseLinear inverse(transform);
    EXPECT_EQ(inverse.divisor, transform.voxel_size * transform.voxel_size);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_EQ(inverse.row[i][j], transform.linear[j][i]);
      }
    }
  }
  for (const VoxelTransform& transform : {test::nearly_cubic(), with_rounded_size()}) {
    EXPECT_TRUE(has_cubic_voxels(transform));
    EXPECT_FALSE(is_scaled_rotation(transform));
  }
}

}  // namespace
}  // namespace tet
