#include "core/mesh/tet_shapes.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

using Places = std::array<WorldPoint, 4>;

const Places kRegular{{{1, -1, -1}, {1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}}};
const Places kCorner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(TetShape, OfTheRegularTetIsOne) {
  const ShapeRatios shape = shape_of(kRegular);
  EXPECT_NEAR(shape.scaled_jacobian, 1, 1e-12);
  EXPECT_NEAR(shape.radius_ratio, 1, 1e-12);
  EXPECT_NEAR(shape.edge_ratio, 1, 1e-12);
}

TEST(TetShape, OfACubesCornerIsWhatGeometrySays) {
  const ShapeRatios shape = shape_of(kCorner);
  // The largest product of edges at a corner is 1 * sqrt(2) * sqrt(2).
  EXPECT_NEAR(shape.scaled_jacobian, std::sqrt(2.0) / 2, 1e-12);
  const double inner = 1 / (3 + std::sqrt(3.0)), outer = std::sqrt(3.0) / 2;
  EXPECT_NEAR(shape.radius_ratio, 3 * inner / outer, 1e-12);
  EXPECT_NEAR(shape.edge_ratio, 1 / std::sqrt(2.0), 1e-12);
}

TEST(TetShape, OfATetThatIsTurnedOverIsNegative) {
  Places turned = kRegular;
  std::swap(turned[0], turned[1]);
  EXPECT_NEAR(shape_of(turned).scaled_jacobian, -1, 1e-12);
}

TEST(TetShape, OfATetWithoutVolumeIsZero) {
  EXPECT_EQ(shape_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}).scaled_jacobian, 0);
  EXPECT_EQ(shape_of({{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 1, 1}}}).edge_ratio, 0);
  EXPECT_EQ(shape_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}).radius_ratio, 0);
}

TEST(MeshShapes, CountEveryTetOnceAndEveryEdgeOfEach) {
  const TetMesh mesh = kuhn_mesh(4);
  const ShapeStats stats = measure_shapes(mesh);
  const std::uint64_t tets = mesh.header.tet_count;
  const auto sum = [](const auto& bins) {
    return std::accumulate(bins.begin(), bins.end(), std::uint64_t{0});
  };
  EXPECT_EQ(sum(stats.scaled_jacobian.histogram), tets);
  EXPECT_EQ(sum(stats.radius_ratio.histogram), tets);
  EXPECT_EQ(sum(stats.edge_ratio.histogram), tets);
  EXPECT_EQ(sum(stats.edges.histogram), 6 * tets);
  EXPECT_EQ(stats.not_positive, 0U);
  // All are alike: edges of 1, sqrt(2) and sqrt(3).
  EXPECT_NEAR(stats.edge_ratio.min, 1 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(stats.edge_ratio.mean(), 1 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(stats.edges.min, 1, 1e-6);
  EXPECT_NEAR(stats.edges.max, std::sqrt(3.0), 1e-6);
}

TEST(MeshShapes, NameTheWorstTetsAndWhereTheyAre) {
  TetMesh mesh = kuhn_mesh(4);
  const auto victim = mesh.tet(77);
  mesh.store_position(victim[3], mesh.stored_position(victim[0]));
  const ShapeStats stats = measure_shapes(mesh);
  ASSERT_EQ(stats.worst.size(), ShapeStats::kWorst);
  EXPECT_LE(stats.worst.front().shape.scaled_jacobian, 0);
  EXPECT_GT(stats.not_positive, 0U);
  for (std::size_t i = 1; i < stats.worst.size(); ++i) {
    EXPECT_LE(stats.worst[i - 1].shape.scaled_jacobian, stats.worst[i].shape.scaled_jacobian);
  }
  const std::uint64_t tet = stats.worst.front().tet;
  WorldPoint middle;
  for (const std::uint64_t vertex : mesh.tet(tet)) middle.x += mesh.vertex(vertex).x / 4;
  EXPECT_NEAR(stats.worst.front().at.x, middle.x, 1e-6);
}

TEST(MeshShapes, AreTheSameForAnyNumberOfThreads) {
  const TetMesh mesh = kuhn_mesh(20);  // more than a range of tets
  ShapeStats one, many;
  TaskPool(1).run([&] { one = measure_shapes(mesh); });
  TaskPool(5).run([&] { many = measure_shapes(mesh); });
  EXPECT_EQ(one.radius_ratio.sum_units, many.radius_ratio.sum_units);
  EXPECT_EQ(one.worst.front().tet, many.worst.front().tet);
}

}  // namespace
}  // namespace tet
