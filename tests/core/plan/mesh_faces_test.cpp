// The boundary faces that come with a mesh, against those that its tets have.
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/mesh/find_faces.h"
#include "core/scene/scene.h"
#include "tests/core/plan/mesh_by_chunks.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::mesh_faces_test {
namespace {

using test::mesh_by_chunks;
using test::same_bytes;

Shape shape_of(Volume volume) { return std::make_shared<const Volume>(std::move(volume)); }

Shape unit_ball() {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  return std::make_shared<const Scene>(writer.scene());
}

MeshRequest with_faces(MeshRequest request = {}) {
  request.faces = true;
  return request;
}

MeshRequest without_faces(MeshRequest request) {
  request.faces = false;
  return request;
}

TetMesh mesh(const Shape& shape, const MeshRequest& request, int threads = 2) {
  TaskPool pool(threads);
  auto made = mesh_volume(pool, {.shape = shape, .request = request});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? std::move(made->mesh) : TetMesh();
}

std::map<std::string, std::uint64_t> count_by_label(const TetMesh& mesh) {
  std::map<std::string, std::uint64_t> counts;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    ++counts[mesh.header.face_labels.at(mesh.face_label(i)).name];
  }
  return counts;
}

/// Compares with what the tets say: every face, its tet, where it begins, its label, no more.
void expect_faces_of_tets(const TetMesh& mesh) {
  TetMesh from_tets(mesh.header);
  set_faces(find_faces(mesh), mesh, from_tets);
  EXPECT_GT(mesh.header.face_count, 0U);
  EXPECT_EQ(mesh.header.face_count, from_tets.header.face_count);
  EXPECT_EQ(mesh.header.face_labels, from_tets.header.face_labels);
  EXPECT_TRUE(std::ranges::equal(mesh.faces.bytes(), from_tets.faces.bytes()));
  EXPECT_TRUE(std::ranges::equal(mesh.face_tets.bytes(), from_tets.face_tets.bytes()));
  EXPECT_TRUE(std::ranges::equal(mesh.face_labels.bytes(), from_tets.face_labels.bytes()));
}

/// Each directed edge has as many triangles along it as against it.
void expect_closed(const TetMesh& mesh) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, int> edges;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const Triangle face = mesh.face(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = face[k], b = face[(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  for (const auto& [edge, sum] : edges) ASSERT_EQ(sum, 0) << edge.first << " " << edge.second;
}

double enclosed_volume(const TetMesh& mesh) {
  double six_volumes = 0;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const auto [a, b, c] = mesh.face(i);
    const WorldPoint p = mesh.vertex(a), q = mesh.vertex(b), r = mesh.vertex(c);
    six_volumes += p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) +
                   p.z * (q.x * r.y - q.y * r.x);
  }
  return six_volumes / 6;
}

std::vector<std::pair<std::string, Volume>> all_fields() {
  std::vector<std::pair<std::string, Volume>> fields;
  for (test::Solid& solid : test::smooth_solids()) {
    fields.emplace_back(solid.name, std::move(solid.volume));
  }
  fields.emplace_back("gyroid", test::gyroid_ball(40));
  fields.emplace_back("random signs", test::random_signs(20, 1));
  fields.emplace_back("random signs and zeros", test::random_signs(20, 2, 3));
  fields.emplace_back("flipped tiles", test::ball_with_flipped_tiles(27));
  fields.emplace_back("fog", test::fog_ball(12.2));
  return fields;
}

TEST(MeshFaces, AreTheBoundaryOfTheTetsOnEveryField) {
  for (const auto& [name, volume] : test::few_of(all_fields(), 4)) {
    for (const int levels : test::few_of(std::vector{0, 1, kMaxLevels}, 2)) {
      SCOPED_TRACE(name + ", levels " + std::to_string(levels));
      expect_faces_of_tets(mesh(shape_of(volume), with_faces(test::with_levels(levels))));
    }
  }
}

TEST(MeshFaces, AreClosedAndOutwards) {
  const TetMesh made = mesh(shape_of(test::gyroid_ball(30)), with_faces());
  expect_closed(made);
  EXPECT_NEAR(enclosed_volume(made), measure_quality(made).volume,
              1e-5 * measure_quality(made).volume);
}

TEST(MeshFaces, AreOutwardsWhereTheLatticeIsMirrored) {
  VoxelTransform mirrored;
  mirrored.linear = {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const TetMesh made = mesh(shape_of(test::ball(9, mirrored)), with_faces());
  expect_faces_of_tets(made);
  EXPECT_NEAR(enclosed_volume(made), 4.0 / 3 * 3.14159 * 729, 60);
}

TEST(MeshFaces, LeaveAllElseAsItIs) {
  const Shape ball = shape_of(test::ball(15));
  TetMesh made = mesh(ball, with_faces());
  made.faces = {};
  made.face_tets = {};
  made.face_labels = {};
  EXPECT_TRUE(same_bytes(made, mesh(ball, {})));
  EXPECT_FALSE(mesh(ball, {}).header.has_faces());
}

TEST(MeshFaces, AreTheSameForAnyThreadsAndChunks) {
  const Shape shape = shape_of(test::gyroid_ball(40));
  const TetMesh one = mesh(shape, with_faces(), 1);
  EXPECT_TRUE(same_bytes(one, mesh(shape, with_faces(), 3)));
  EXPECT_TRUE(same_bytes(one, mesh_by_chunks(shape, with_faces())));
  EXPECT_TRUE(same_bytes(one, mesh_by_chunks(shape, with_faces(), 1 << 14)));
}

TEST(MeshFaces, AreFoundAgainWhereGeometryWasNotKept) {
  const Shape shape = shape_of(test::gyroid_ball(30));
  TaskPool pool(2);
  const auto made = mesh_volume(
      pool, {.shape = shape, .request = with_faces(), .limits = {.kept_geometry_bytes = 0}});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(same_bytes(made->mesh, mesh(shape, with_faces())));
}

TEST(MeshFaces, CountAsBytesOfTheirChunks) {
  const Shape shape = shape_of(test::ball(20));
  const TetMesh made = mesh(shape, with_faces());
  const ChunkSizes sizes(made.header, whole_of(made.header));
  EXPECT_EQ(sizes.total(), made.header.vertex_count * 12 + made.header.tet_count * 16 +
                               made.header.face_count * 18);
}

TEST(MeshFaces, HaveIdsOfEightBytesWhereTheMeshHas) {
  MeshRequest wide = with_faces();
  wide.indices = IndexType::kUint64;
  expect_faces_of_tets(mesh(shape_of(test::ball(9)), wide));
}

TEST(MeshFaces, OfAManifoldAreThoseOfItsTets) {
  MeshRequest manifold = with_faces();
  manifold.manifold = true;
  expect_faces_of_tets(mesh(shape_of(test::random_signs(16, 5)), manifold));
}

TEST(MeshFaces, OfAnImprovedMeshAreThoseOfItsTets) {
  MeshRequest improved = with_faces();
  improved.improve = true;
  const Shape shape = shape_of(test::ball(12));
  const TetMesh made = mesh(shape, improved);
  expect_faces_of_tets(made);
  EXPECT_TRUE(same_bytes(made, mesh_by_chunks(shape, improved, 1 << 15)));
}

TEST(MeshFaces, OfACutSayWhichFaceOfTheBoxTheyLieIn) {
  MeshRequest half = with_faces();
  half.spacing = 0.1;
  half.box = WorldBox{{-2, -2, -2}, {0, 2, 2}};
  const TetMesh made = mesh(unit_ball(), half);
  expect_faces_of_tets(made);
  expect_closed(made);
  const auto counts = count_by_label(made);
  EXPECT_EQ(counts.size(), 2U);
  EXPECT_GT(counts.at("surface"), counts.at("cut_x_max"));
  for (std::uint64_t i = 0; i < made.header.face_count; ++i) {
    if (made.header.face_labels[made.face_label(i)].kind != FaceKind::kBox) continue;
    for (const std::uint64_t vertex : made.face(i)) ASSERT_EQ(made.vertex(vertex).x, 0);
  }
  EXPECT_TRUE(same_bytes(made, mesh_by_chunks(unit_ball(), half)));
  half.improve = true;
  expect_faces_of_tets(mesh(unit_ball(), half));
}

TEST(MeshFaces, OfAGradedSurfaceAreThoseOfItsTets) {
  MeshRequest graded = with_faces();
  graded.spacing = 0.05;
  graded.sizing.grade_surface = true;
  graded.sizing.coarsest = 0.2;
  expect_faces_of_tets(mesh(unit_ball(), graded));
}

/// A box that the surface crosses, off the lattice of bricks.
MeshRequest both_sides(double half_edge) {
  MeshRequest request = with_faces();
  request.preset = Preset::kBothSides;
  request.box = WorldBox{{-half_edge, -half_edge, -half_edge}, {half_edge, half_edge, 8}};
  return request;
}

/// Compares triangles and tets with what the tets say, and which lie between the regions; and,
/// where the lattice lies along the world's axes, which lie in which face of the box.
void expect_faces_of_both_sides(const TetMesh& mesh, bool lies_along = true) {
  TetMesh from_tets(mesh.header);
  set_faces(find_faces(mesh), mesh, from_tets);
  ASSERT_EQ(mesh.header.face_count, from_tets.header.face_count);
  EXPECT_TRUE(std::ranges::equal(mesh.faces.bytes(), from_tets.faces.bytes()));
  EXPECT_TRUE(std::ranges::equal(mesh.face_tets.bytes(), from_tets.face_tets.bytes()));
  std::uint64_t differ = 0;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const std::uint16_t label = mesh.face_label(i), found = from_tets.face_label(i);
    differ += lies_along ? label != found : (label == 0) != (found == 0);
  }
  EXPECT_EQ(differ, 0U) << "of " << mesh.header.face_count;
}

/// Looks whether every vertex of a face lies within a spacing of its face of the box, and a
/// flat one in it.
void expect_labels_of_box(const TetMesh& mesh) {
  const WorldBox box = *mesh.header.box;
  const std::array<double, 6> place{box.min.x, box.max.x, box.min.y,
                                    box.max.y, box.min.z, box.max.z};
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const std::uint16_t label = mesh.face_label(i);
    if (label == 0) continue;
    std::array<double, 6> farthest{};
    for (const std::uint64_t vertex : mesh.face(i)) {
      const auto [x, y, z] = mesh.vertex(vertex);
      const std::array at{x, y, z};
      for (std::size_t f = 0; f < 6; ++f) {
        farthest[f] = std::max(farthest[f], std::abs(at[f / 2] - place[f]));
      }
    }
    ASSERT_LT(farthest[label - 1U], 1) << i;
    const bool is_flat = std::ranges::count(farthest, 0.0) > 0;
    ASSERT_TRUE(!is_flat || farthest[label - 1U] == 0) << i;
  }
}

TEST(MeshFaces, OfBothSidesAreThoseBetweenThemAndThoseOfTheBox) {
  for (const auto& [name, volume] : test::few_of(all_fields(), 4)) {
    for (const int levels : test::few_of(std::vector{0, 2, kMaxLevels}, 2)) {
      SCOPED_TRACE(name + ", levels " + std::to_string(levels));
      MeshRequest request = both_sides(9);
      request.levels = levels;
      const TetMesh made = mesh(shape_of(volume), request);
      expect_faces_of_both_sides(made);
      expect_labels_of_box(made);
    }
  }
}

TEST(MeshFaces, OfBothSidesAreFoundWhereNothingCutsTheBox) {
  MeshRequest request = both_sides(20);
  request.box->max.z = 20;
  const TetMesh made = mesh(shape_of(test::ball(9)), request);
  expect_faces_of_both_sides(made);
  expect_labels_of_box(made);
  const auto counts = count_by_label(made);
  EXPECT_EQ(counts.size(), 7U);
  EXPECT_EQ(counts.at("interface"), measure_inside_boundary(made).triangles);
  EXPECT_TRUE(same_bytes(made, mesh_by_chunks(shape_of(test::ball(9)), request, 1 << 15)));
}

TEST(MeshFaces, OfBothSidesAreOutwardsWhereTheLatticeIsMirrored) {
  VoxelTransform mirrored;
  mirrored.linear = {{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}};
  const TetMesh made = mesh(shape_of(test::ball(12, mirrored)), both_sides(9));
  expect_faces_of_both_sides(made, false);
}

TEST(MeshFaces, OfSeveralGridsAreNamedByThem) {
  Volume bone = test::ball(12), joint = test::ball(9);
  bone.name = "bone";
  joint.name = "joint";
  joint.transform.translation = {40.3, -7.1, 3.7};
  const Shape grids = GridList{std::make_shared<const Volume>(std::move(bone)),
                               std::make_shared<const Volume>(std::move(joint))};
  const TetMesh made = mesh(grids, with_faces());
  expect_faces_of_tets(made);
  const auto counts = count_by_label(made);
  EXPECT_GT(counts.at("bone_surface"), counts.at("joint_surface"));
  EXPECT_EQ(counts.size(), 2U);
  EXPECT_TRUE(same_bytes(made, mesh_by_chunks(grids, with_faces(), 1 << 15)));
  EXPECT_EQ(made.header.vertex_count,
            mesh(grids, without_faces(with_faces())).header.vertex_count);
}

}  // namespace
}  // namespace tet::mesh_faces_test
