#include "core/mesh/regions.h"

#include <gtest/gtest.h>

#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

TEST(Regions, OfAMeshWithoutThemAreAllInside) {
  const TetMesh mesh = kuhn_mesh(2);
  EXPECT_EQ(count_tets(mesh, MeshRegion::kInside), mesh.header.tet_count);
  EXPECT_EQ(count_tets(mesh, MeshRegion::kOutside), 0U);
  EXPECT_DOUBLE_EQ(measure_volume(mesh, MeshRegion::kInside), 8);
  EXPECT_EQ(measure_volume(mesh, MeshRegion::kOutside), 0);
}

TEST(Regions, ShareTheTetsAndTheVolume) {
  const TetMesh mesh =
      with_regions(kuhn_mesh(20), [](std::uint64_t tet) { return tet % 3 == 0; });
  EXPECT_EQ(count_tets(mesh, MeshRegion::kInside), 16'000U);
  EXPECT_EQ(count_tets(mesh, MeshRegion::kOutside), 32'000U);
  EXPECT_NEAR(measure_volume(mesh, MeshRegion::kInside), 8000.0 / 3, 1e-9);
  EXPECT_NEAR(measure_volume(mesh, MeshRegion::kOutside), 16000.0 / 3, 1e-9);
}

}  // namespace
}  // namespace tet
