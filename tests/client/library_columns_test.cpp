// What the public library shows of a mesh's columns.
#include <cstring>

#include <gtest/gtest.h>

#include "client/library/api/to_public.h"
#include "tests/core/mesh/small_meshes.h"

namespace tetstream {
namespace {

TEST(LibraryColumns, HaveRegionsOfBothSides) {
  const tet::TetMesh mesh =
      tet::with_regions(tet::kuhn_mesh(1), [](std::uint64_t tet) { return tet == 0; });
  const MeshColumns columns = columns_of(mesh);
  ASSERT_EQ(columns.regions.size(), mesh.header.tet_count);
  EXPECT_EQ(columns.regions[0], 1);
  EXPECT_EQ(columns.regions[1], 2);
}

TEST(LibraryColumns, HaveTheNumbersOfLabelsAndNotAsRegions) {
  tet::TetMesh mesh = tet::kuhn_mesh(1);
  mesh.header.labels = {{4, "bone"}, {7, "marrow"}};
  mesh.regions = tet::ByteBuffer(mesh.header.tet_count * sizeof(tet::LabelNumber));
  std::memset(mesh.regions.bytes().data(), 0, mesh.regions.size());
  EXPECT_TRUE(columns_of(mesh).regions.empty());
  EXPECT_EQ(columns_of(mesh).labels.size(), mesh.header.tet_count);
  EXPECT_EQ(to_public(mesh.header, "").labels.at(1).name, "marrow");
}

/// A server of another kind may say any number: none of them is success.
TEST(LibraryStatus, OfACodeThatThereIsNotIsUnknown) {
  for (const int code : {17, 256, 512, -256}) {
    const absl::Status odd(static_cast<absl::StatusCode>(code), "odd");
    EXPECT_EQ(to_public(odd).code(), StatusCode::kUnknown) << code;
  }
}

}  // namespace
}  // namespace tetstream
