#include <cstdint>

#include <gtest/gtest.h>

#include "core/mesh/stable/stable_mesh.h"

namespace tet::stable_mesh_memory_test {
namespace {

TEST(StableMesh, IsEmptyWhereThereIsNoMemoryForTheNext) {
  MeshHeader header;
  header.vertex_count = 4;
  header.tet_count = 1;
  StableMesh mesh;
  ASSERT_TRUE(mesh.begin(header, nullptr).ok());
  MeshHeader next = header;
  next.vertex_count = std::uint64_t{1} << 50;
  const KeptParts kept{{{0, 0, 4}}, {{0, 0, 1}}};
  EXPECT_TRUE(absl::IsResourceExhausted(mesh.begin(next, &kept)));
  EXPECT_EQ(mesh.vertices().slots(), 0U);
  EXPECT_EQ(mesh.tets().slots(), 0U);
  const auto left = mesh.in_order();
  ASSERT_TRUE(left.ok()) << left.status();
  EXPECT_EQ(left->header.vertex_count, 0U);
}

}  // namespace
}  // namespace tet::stable_mesh_memory_test
