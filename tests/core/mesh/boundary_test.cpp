#include "core/mesh/boundary.h"

#include <cmath>

#include <gmock/gmock.h>

#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

using ::testing::ElementsAre;

BoundaryTopology topology_of(const std::vector<Corners>& tets) {
  const std::vector<WorldPoint> no_matter_where(16);
  return measure_boundary(make_mesh(no_matter_where, tets));
}

TEST(Boundary, OfOneTetIsItsFourFacesSeenFromOutside) {
  EXPECT_THAT(boundary_triangles(one_tet()), ElementsAre(Triangle{0, 2, 1}, Triangle{0, 1, 3},
                                                         Triangle{0, 3, 2}, Triangle{1, 2, 3}));
}

TEST(Boundary, OfOneTetIsASphere) {
  const BoundaryTopology topology = measure_boundary(one_tet());
  EXPECT_EQ(topology.triangles, 4U);
  EXPECT_EQ(topology.vertices, 4U);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_EQ(topology.non_manifold_edges, 0U);
  EXPECT_EQ(topology.non_manifold_vertices, 0U);
}

TEST(Boundary, LeavesOutASharedFace) {
  const BoundaryTopology topology = topology_of({{0, 1, 2, 3}, {1, 2, 3, 4}});
  EXPECT_EQ(topology.triangles, 6U);
  EXPECT_EQ(topology.vertices, 5U);
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_EQ(topology.non_manifold_edges, 0U);
  EXPECT_EQ(topology.non_manifold_vertices, 0U);
}

TEST(Boundary, CountsASharedEdgeAsNonManifold) {
  const BoundaryTopology topology = topology_of({{0, 1, 2, 3}, {0, 1, 4, 5}});
  EXPECT_EQ(topology.triangles, 8U);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic, 6 - 11 + 8);
  EXPECT_EQ(topology.non_manifold_edges, 1U);
  EXPECT_EQ(topology.non_manifold_vertices, 2U);
}

TEST(Boundary, CountsASharedVertexAsNonManifold) {
  const BoundaryTopology topology = topology_of({{0, 1, 2, 3}, {0, 4, 5, 6}});
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic, 7 - 12 + 8);
  EXPECT_EQ(topology.non_manifold_edges, 0U);
  EXPECT_EQ(topology.non_manifold_vertices, 1U);
}

TEST(Boundary, TellsComponentsApart) {
  const BoundaryTopology topology = topology_of({{0, 1, 2, 3}, {4, 5, 6, 7}});
  EXPECT_EQ(topology.components, 2U);
  EXPECT_EQ(topology.euler_characteristic, 4);
  EXPECT_EQ(topology.non_manifold_vertices, 0U);
}

TEST(Boundary, OfACubeOfSixTetsIsTwelveTriangles) {
  const BoundaryTopology topology = measure_boundary(kuhn_mesh(1));
  EXPECT_EQ(topology.triangles, 12U);
  EXPECT_EQ(topology.vertices, 8U);
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_EQ(topology.non_manifold_edges, 0U);
}

TEST(Boundary, OfACubeOfFiveTetsIsTwelveTriangles) {
  // The ids of lattice_points(1) are xyz in binary.
  const BoundaryTopology topology =
      topology_of({{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}});
  EXPECT_EQ(topology.triangles, 12U);
  EXPECT_EQ(topology.euler_characteristic, 2);
}

TEST(Boundary, SkipsInnerFacesBetweenBoundaryVertices) {
  // In a 1 x 1 x n bar every vertex is on the boundary, and every inner face is a candidate.
  const TetMesh bar = kuhn_mesh(5, [](int x, int y, int) { return x == 2 && y == 2; });
  const BoundaryTopology topology = measure_boundary(bar);
  EXPECT_EQ(topology.triangles, 2U * (2 + 4 * 5));
  EXPECT_EQ(topology.vertices, 4U * 6);
  EXPECT_EQ(topology.euler_characteristic, 2);
}

TEST(Boundary, OfARingIsATorus) {
  const TetMesh ring =
      kuhn_mesh(3, [](int x, int y, int z) { return z == 0 && !(x == 1 && y == 1); });
  const BoundaryTopology topology = measure_boundary(ring);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic, 0);
  EXPECT_EQ(topology.non_manifold_edges, 0U);
  EXPECT_EQ(topology.non_manifold_vertices, 0U);
}

TEST(Boundary, OfABallWithACavityIsTwoSpheres) {
  const TetMesh hollow =
      kuhn_mesh(3, [](int x, int y, int z) { return !(x == 1 && y == 1 && z == 1); });
  const BoundaryTopology topology = measure_boundary(hollow);
  EXPECT_EQ(topology.components, 2U);
  EXPECT_EQ(topology.euler_characteristic, 4);
  EXPECT_EQ(topology.triangles, 12U * 9 + 12U);
}

TEST(Boundary, OfTheInsideAloneSkipsTheTetsOutside) {
  // The cube in the middle of 27, and those around it.
  const TetMesh mesh =
      with_regions(kuhn_mesh(3), [](std::uint64_t tet) { return tet / 6 == 13; });
  const BoundaryTopology topology = measure_inside_boundary(mesh);
  EXPECT_EQ(topology.triangles, 12U);
  EXPECT_EQ(topology.vertices, 8U);
  EXPECT_EQ(topology.euler_characteristic, 2);
  const TetMesh outside = with_regions(kuhn_mesh(3), [](std::uint64_t) { return false; });
  EXPECT_EQ(measure_boundary(mesh), measure_boundary(kuhn_mesh(3)));
  EXPECT_EQ(boundary_triangles(mesh, MeshRegion::kOutside).size(), 12U * 9 + 12U);
  EXPECT_EQ(measure_inside_boundary(outside), BoundaryTopology{});
}

TEST(Boundary, TrianglesEncloseTheVolumeOfTheTets) {
  const TetMesh mesh = kuhn_mesh(4, [](int x, int y, int z) { return (x + y + z) % 3 != 0; });
  double six_volumes = 0;
  for (const auto& [a, b, c] : boundary_triangles(mesh)) {
    const WorldPoint p = mesh.vertex(a), q = mesh.vertex(b), r = mesh.vertex(c);
    six_volumes += p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) +
                   p.z * (q.x * r.y - q.y * r.x);
  }
  EXPECT_DOUBLE_EQ(six_volumes, static_cast<double>(mesh.header.tet_count));
}

TEST(Boundary, OfNothingIsNothing) {
  const BoundaryTopology topology = topology_of({});
  EXPECT_EQ(topology.triangles, 0U);
  EXPECT_EQ(topology.components, 0U);
  EXPECT_EQ(topology.euler_characteristic, 0);
}

}  // namespace
}  // namespace tet
