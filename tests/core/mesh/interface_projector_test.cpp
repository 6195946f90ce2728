#include "core/mesh/improve/interface_projector.h"

#include <gtest/gtest.h>

#include "tests/support/nearly_cubic.h"

namespace tet {
namespace {

TEST(InterfaceProjector, FindsTheLatticeFarOutWhereItIsNearlyCubic) {
  const VoxelTransform lattice = test::nearly_cubic();
  const VoxelCoord at = test::kFarVoxel;
  MeshHeader header;
  header.spacing = lattice.voxel_size;
  header.coordinate_type = CoordinateType::kFloat64;
  const InterfaceProjector projector(nullptr, {lattice.linear, {}, lattice.mirrors()}, header);
  const auto& m = lattice.linear;
  const auto along = [&](std::size_t row) {
    return m[row][0] * at.x + m[row][1] * at.y + m[row][2] * at.z;
  };
  const WorldPoint found = projector.lattice_of({along(0), along(1), along(2)});
  EXPECT_NEAR(found.x, at.x, 1e-6);
  EXPECT_NEAR(found.y, at.y, 1e-6);
  EXPECT_NEAR(found.z, at.z, 1e-6);
}

}  // namespace
}  // namespace tet
