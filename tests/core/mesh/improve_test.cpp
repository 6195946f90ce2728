// What the improvement promises of any mesh, on one whose boundary is no surface;
// tests/core/plan holds what it promises of meshes of solids.
#include "core/mesh/improve/improve.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/mesh/quality.h"
#include "tests/core/mesh/small_meshes.h"
#include "tests/support/conformity.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

constexpr int kEdge = 14;

bool is_inner(std::uint64_t vertex) {
  constexpr std::uint64_t kRow = kEdge + 1;
  for (const std::uint64_t i : {vertex / kRow / kRow, vertex / kRow % kRow, vertex % kRow}) {
    if (i == 0 || i == kEdge) return false;
  }
  return true;
}

/// A Kuhn mesh whose inner vertices were shaken, but not so much that a tet turned over.
TetMesh shaken_mesh(const Storage& storage = {}) {
  TetMesh mesh = kuhn_mesh(
      kEdge, [](int, int, int) { return true; }, storage);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> step(-0.22, 0.22);
  for (std::uint64_t v = 0; v < mesh.header.vertex_count; ++v) {
    const auto [x, y, z] = mesh.stored_position(v);
    const WorldPoint shaken{x + step(random), y + step(random), z + step(random)};
    if (is_inner(v)) mesh.store_position(v, shaken);
  }
  return mesh;
}

/// Improves within a ball whose surface is far from the mesh.
Improvement improve(TetMesh& mesh, int threads = 2, const Cancellation& cancellation = {}) {
  const Volume volume = test::ball(60);
  PhiField field;
  field.volume = &volume;
  const LatticeToWorld to_world{volume.transform.linear, {}, false};
  Improvement improvement;
  TaskPool(threads).run(
      [&] { improvement = improve_mesh(mesh, field, to_world, {}, cancellation); });
  return improvement;
}

TEST(Improve, RaisesTheSmallestAngleAndLowersTheLargest) {
  for (const auto coordinates : {CoordinateType::kFloat32, CoordinateType::kFloat64}) {
    TetMesh mesh = shaken_mesh({.coordinates = coordinates});
    const QualityStats before = measure_quality(mesh);
    ASSERT_LT(before.min_dihedral_deg, 15);
    const Improvement improvement = improve(mesh);
    const QualityStats after = measure_quality(mesh);
    EXPECT_GT(after.min_dihedral_deg, 20);
    EXPECT_LT(after.max_dihedral_deg, before.max_dihedral_deg);
    EXPECT_NEAR(after.volume, before.volume, 1e-4);
    EXPECT_TRUE(check_conformity(mesh).conforming()) << check_conformity(mesh).describe();
    EXPECT_EQ(improvement.min_dihedral_before_deg, before.min_dihedral_deg);
    EXPECT_EQ(improvement.max_dihedral_before_deg, before.max_dihedral_deg);
  }
}

TEST(Improve, KeepsTheTetsAndABoundaryThatIsNotTheSurface) {
  const TetMesh before = shaken_mesh();
  TetMesh after = shaken_mesh();
  const Improvement improvement = improve(after);
  EXPECT_TRUE(std::ranges::equal(before.tets.bytes(), after.tets.bytes()));
  std::uint64_t moved = 0;
  for (std::uint64_t v = 0; v < before.header.vertex_count; ++v) {
    if (before.stored_position(v) == after.stored_position(v)) continue;
    EXPECT_TRUE(is_inner(v)) << "vertex " << v;
    const Vector way = from_to(before.stored_position(v), after.stored_position(v));
    EXPECT_LE(dot(way, way), 0.25 + 1e-6);
    ++moved;
  }
  EXPECT_GT(moved, 100U);
  EXPECT_EQ(moved, improvement.moved_vertices);
}

TEST(Improve, IsTheSameForAnyNumberOfThreads) {
  TetMesh one = shaken_mesh();
  improve(one, 1);
  for (const int threads : {2, 16}) {
    TetMesh many = shaken_mesh();
    improve(many, threads);
    EXPECT_TRUE(std::ranges::equal(one.positions.bytes(), many.positions.bytes()));
  }
}

TEST(Improve, MovesTheSameWithWideIds) {
  TetMesh narrow = shaken_mesh(), wide = shaken_mesh({.ids = IndexType::kUint64});
  improve(narrow);
  improve(wide);
  EXPECT_TRUE(std::ranges::equal(narrow.positions.bytes(), wide.positions.bytes()));
}

TEST(Improve, LeavesAGoodMeshAlone) {
  TetMesh mesh = kuhn_mesh(kEdge);
  EXPECT_EQ(improve(mesh).moved_vertices, 0U);
  TetMesh nothing = make_mesh({}, {});
  EXPECT_EQ(improve(nothing).moved_vertices, 0U);
}

TEST(Improve, StopsWhenCancelled) {
  TetMesh mesh = shaken_mesh();
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_EQ(improve(mesh, 2, cancelled).moved_vertices, 0U);
}

}  // namespace
}  // namespace tet
