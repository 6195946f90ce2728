#include "core/mesh/tet_mesh.h"

#include <gmock/gmock.h>

#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

using ::testing::ElementsAre;

TEST(TetMesh, ReadsBackEveryStorage) {
  for (const auto coordinates : {CoordinateType::kFloat32, CoordinateType::kFloat64}) {
    for (const auto ids : {IndexType::kUint32, IndexType::kUint64}) {
      const TetMesh mesh = one_tet({coordinates, ids, {10, 20, 30}});
      EXPECT_EQ(mesh.vertex(1), (WorldPoint{11, 20, 30}));
      EXPECT_EQ(mesh.stored_position(3), (WorldPoint{0, 0, 1}));
      EXPECT_THAT(mesh.tet(0), ElementsAre(0, 1, 2, 3));
    }
  }
}

TEST(TetMesh, AddsAFarOriginInDouble) {
  const TetMesh mesh = one_tet({.origin = {1e9 + 0.25, 0, 0}});
  EXPECT_EQ(mesh.vertex(1).x, 1e9 + 1.25);
}

TEST(TetMesh, HoldsBytesForTheTotalsOfItsHeader) {
  MeshHeader header;
  header.vertex_count = 5;
  header.tet_count = 2;
  header.index_type = IndexType::kUint64;
  const TetMesh mesh(header);
  EXPECT_EQ(mesh.positions.size(), 5U * 3 * 4);
  EXPECT_EQ(mesh.tets.size(), 2U * 4 * 8);
}

TEST(TetMesh, PlacesChunksSideBySide) {
  TetMesh mesh = kuhn_mesh(1);
  const ChunkExtent first{.first_vertex = 0, .vertex_count = 5, .first_tet = 0, .tet_count = 2};
  const ChunkExtent second{
      .first_vertex = 5, .vertex_count = 3, .first_tet = 2, .tet_count = 4};
  EXPECT_EQ(mesh.columns_of(first).positions.data(), mesh.positions.bytes().data());
  const ChunkColumns columns = mesh.columns_of(second);
  EXPECT_EQ(columns.positions.data(), mesh.positions.bytes().data() + 5 * 12);
  EXPECT_EQ(columns.positions.size(), 3U * 12);
  EXPECT_EQ(columns.tets.data(), mesh.tets.bytes().data() + 2 * 16);
  EXPECT_EQ(columns.tets.size(), 4U * 16);
  EXPECT_TRUE(columns.regions.empty());
}

}  // namespace
}  // namespace tet
