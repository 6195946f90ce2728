// Regions of the surface that are divided where it has creases.
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/face_counts.h"
#include "core/scene/scene.h"
#include "tests/core/plan/mesh_by_chunks.h"
#include "tests/core/plan/meshing.h"
#include "tests/core/plan/some_face_regions.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::creases_test {
namespace {

using test::mesh_by_chunks;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

MeshRequest request_of(std::vector<FaceRegion> regions, double spacing) {
  MeshRequest request;
  request.spacing = spacing;
  request.faces = true;
  request.face_regions = std::move(regions);
  return request;
}

absl::StatusOr<MeshResult> try_to_mesh(const Shape& shape,
                                       const MeshRequest& request,
                                       MeshLimits limits = {},
                                       int threads = 2) {
  TaskPool pool(threads);
  return mesh_volume(pool, {.shape = shape, .request = request, .limits = limits});
}

TetMesh mesh_of(const Shape& shape, const MeshRequest& request, int threads = 2) {
  auto made = try_to_mesh(shape, request, {}, threads);
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? std::move(made->mesh) : TetMesh();
}

Shape scene_shape(const test::SceneWriter& writer) {
  return std::make_shared<const Scene>(writer.scene());
}

/// 2.07 x 1.53 x 1.11 about the origin.
Shape block() {
  test::SceneWriter writer;
  scene::RoundedBox box;
  box.size = {2.07, 1.53, 1.11};
  writer.add(box);
  return scene_shape(writer);
}

/// 3 x 2 x 0.6 with a bore of radius 0.5 along z.
Shape bored_plate() {
  test::SceneWriter writer;
  scene::RoundedBox box;
  box.size = {3, 2, 0.6};
  const std::string body = writer.add(box);
  const std::string bore = writer.add(scene::Cylinder{0.5, 2});
  writer.add(scene::Combination{scene::Combine::kDifference, {body, bore}, 0});
  return scene_shape(writer);
}

std::map<std::string, std::uint64_t> counts_by_name(const TetMesh& mesh) {
  std::map<std::string, std::uint64_t> counts;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    ++counts[mesh.header.face_labels.at(mesh.face_label(i)).name];
  }
  return counts;
}

std::vector<std::string> names_of(const TetMesh& mesh) {
  std::vector<std::string> names;
  for (const FaceLabel& label : mesh.header.face_labels) names.push_back(label.name);
  return names;
}

WorldPoint middle_of_face(const TetMesh& mesh, std::uint64_t face) {
  WorldPoint middle;
  for (const std::uint64_t vertex : mesh.face(face)) {
    const auto [x, y, z] = mesh.vertex(vertex);
    middle = {middle.x + x / 3, middle.y + y / 3, middle.z + z / 3};
  }
  return middle;
}

TEST(Creases, OfABlockDivideItIntoItsSixSides) {
  const TetMesh made = mesh_of(block(), request_of({divided("side", 35)}, 0.1));
  EXPECT_THAT(names_of(made), ElementsAre("surface", "side.1", "side.2", "side.3", "side.4",
                                          "side.5", "side.6"));
  // Which sides of the block the flat faces of each patch lie in, away from the bevels.
  std::map<std::uint16_t, std::set<int>> sides;
  for (std::uint64_t i = 0; i < made.header.face_count; ++i) {
    const auto [x, y, z] = middle_of_face(made, i);
    const std::array<double, 3> at{x, y, z}, half{1.035, 0.765, 0.555};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      if (std::abs(half[k] - std::abs(at[k])) > 1e-5) continue;
      sides[made.face_label(i)].insert(2 * axis + (at[k] > 0 ? 1 : 0));
    }
  }
  EXPECT_EQ(sides.size(), 6U);
  for (const auto& [label, on] : sides) EXPECT_EQ(on.size(), 1U) << label;
  std::uint64_t before = made.header.face_count;
  for (const auto& [name, count] : counts_by_name(made)) {
    EXPECT_LE(count, before) << name << " is no larger than the patch before it";
    before = count;
  }
  EXPECT_EQ(made.header.face_labels.back().kind, FaceKind::kRegion);
}

TEST(Creases, SetABoreApartFromItsPlate) {
  const TetMesh made = mesh_of(bored_plate(), request_of({divided("side", 40)}, 0.07));
  std::set<std::uint16_t> on_bore, elsewhere;
  for (std::uint64_t i = 0; i < made.header.face_count; ++i) {
    const auto [x, y, z] = middle_of_face(made, i);
    const bool is_on_bore = std::abs(std::hypot(x, y) - 0.5) < 0.01 && std::abs(z) < 0.2;
    if (is_on_bore) on_bore.insert(made.face_label(i));
    if (std::hypot(x, y) > 0.6) elsewhere.insert(made.face_label(i));
  }
  EXPECT_EQ(counts_by_name(made).size(), 7U);
  EXPECT_EQ(on_bore.size(), 1U);
  EXPECT_EQ(elsewhere.size(), 6U);
  EXPECT_FALSE(elsewhere.contains(*on_bore.begin()));
}

TEST(Creases, LeaveASmoothSurfaceWhole) {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  const TetMesh made = mesh_of(scene_shape(writer), request_of({divided("skin", 60)}, 0.1));
  EXPECT_EQ(counts_by_name(made),
            (std::map<std::string, std::uint64_t>{{"skin.1", made.header.face_count}}));
}

TEST(Creases, OfAThinPlateLeaveItsRimInPatchesOfItsOwn) {
  test::SceneWriter writer;
  scene::RoundedBox plate;
  plate.size = {3, 2, 0.4};
  writer.add(plate);
  const TetMesh made = mesh_of(scene_shape(writer), request_of({divided("side", 35)}, 0.1));
  EXPECT_EQ(counts_by_name(made).size(), 6U);
  std::set<std::uint16_t> on_rim;
  for (std::uint64_t i = 0; i < made.header.face_count; ++i) {
    const auto [x, y, z] = middle_of_face(made, i);
    const bool is_on_rim = std::abs(std::abs(x) - 1.5) < 1e-5 && std::abs(y) < 0.8;
    if (is_on_rim && std::abs(z) < 0.08) on_rim.insert(made.face_label(i));
  }
  EXPECT_EQ(on_rim.size(), 2U) << "one at each end";
}

TEST(Creases, AreFoundAmongTheFacesOfTheirRegionAlone) {
  FaceRegion top{"top"};
  top.facing = {{0, 0, 1}, 30};
  FaceRegion left = divided("left", 35);
  left.half_space = {{1, 0, 0}, -0.02};
  const TetMesh made = mesh_of(block(), request_of({top, left, divided("rest", 35)}, 0.1));
  const auto counts = counts_by_name(made);
  EXPECT_TRUE(counts.contains("top"));
  EXPECT_TRUE(counts.contains("left.4"));
  EXPECT_FALSE(counts.contains("left.5"));
  EXPECT_TRUE(counts.contains("rest.4"));
  EXPECT_FALSE(counts.contains("rest.5"));
  for (std::uint64_t i = 0; i < made.header.face_count; ++i) {
    const std::string& name = made.header.face_labels.at(made.face_label(i)).name;
    const double x = middle_of_face(made, i).x;
    if (name == "top" || std::abs(x + 0.02) < 1e-5) continue;
    ASSERT_EQ(name.starts_with("left"), x < -0.02) << name;
  }
}

TEST(Creases, AreTheSameForAnyThreadsAndChunksAndLeaveAllElse) {
  const std::vector<FaceRegion> regions{in_box("left", {-2, -2, -2}, {-1, 2, 2}),
                                        divided("side", 40)};
  for (const int levels : {kMaxLevels, 0}) {
    MeshRequest request = request_of(regions, 0.06);
    request.levels = levels;
    TetMesh one = mesh_of(bored_plate(), request, 1);
    EXPECT_TRUE(test::same_bytes(one, mesh_of(bored_plate(), request, 3)));
    const TetMesh in_chunks = mesh_by_chunks(bored_plate(), request, 1 << 14);
    EXPECT_GT(in_chunks.header.chunk_count, 50U);
    EXPECT_TRUE(test::same_bytes(one, in_chunks));
    EXPECT_EQ(one.header.face_labels, in_chunks.header.face_labels);
    request.face_regions.clear();
    const TetMesh without = mesh_of(bored_plate(), request);
    std::ranges::copy(without.face_labels.bytes(), one.face_labels.bytes().begin());
    EXPECT_TRUE(test::same_bytes(one, without));
  }
}

TEST(Creases, GoWithCutsAndGradedSurfacesAndImprovementAndBothSides) {
  MeshRequest cut = request_of({divided("side", 40)}, 0.1);
  cut.box = WorldBox{{-3, -3, -3}, {3, 0, 3}};
  const auto of_cut = counts_by_name(mesh_of(block(), cut));
  EXPECT_TRUE(of_cut.contains("cut_y_max"));
  EXPECT_TRUE(of_cut.contains("side.5"));
  EXPECT_FALSE(of_cut.contains("side.6"));
  MeshRequest graded = request_of({divided("side", 40)}, 0.05);
  graded.sizing.grade_surface = true;
  graded.sizing.coarsest = 0.1;
  const TetMesh of_graded = mesh_of(block(), graded);
  EXPECT_TRUE(counts_by_name(of_graded).contains("side.6"));
  EXPECT_TRUE(test::same_bytes(of_graded, mesh_by_chunks(block(), graded, 1 << 14)));
  MeshRequest improved = request_of({divided("side", 40)}, 0.1);
  improved.improve = true;
  const TetMesh of_improved = mesh_of(block(), improved);
  EXPECT_EQ(counts_by_name(of_improved).size(), 6U);
  EXPECT_TRUE(test::same_bytes(of_improved, mesh_by_chunks(block(), improved, 1 << 14)));
  MeshRequest both = request_of({divided("side", 40)}, 0.1);
  both.preset = Preset::kBothSides;
  const auto of_both = counts_by_name(mesh_of(block(), both));
  EXPECT_TRUE(of_both.contains("side.6"));
  EXPECT_FALSE(of_both.contains("interface"));
  EXPECT_TRUE(of_both.contains("box_x_min"));
}

TEST(Creases, OfSeveralGridsAreNamedByThem) {
  Volume bone = test::ball(12), joint = test::ball(9);
  bone.name = "bone";
  joint.name = "joint";
  joint.transform.translation = {40.3, -7.1, 3.7};
  const Shape grids = GridList{std::make_shared<const Volume>(std::move(bone)),
                               std::make_shared<const Volume>(std::move(joint))};
  MeshRequest request;
  request.faces = true;
  request.face_regions = {in_box("near", {-99, -99, -99}, {0.1, 99, 99}), divided("skin", 60)};
  const TetMesh made = mesh_of(grids, request);
  EXPECT_THAT(names_of(made), ElementsAre("bone_surface", "bone_near", "bone_skin.1",
                                          "joint_surface", "joint_near", "joint_skin.1"));
  EXPECT_EQ(made.header.face_labels.back().part, 2U);
  EXPECT_GT(counts_by_name(made).at("joint_skin.1"), 100U);
  EXPECT_TRUE(test::same_bytes(made, mesh_by_chunks(grids, request, 1 << 14)));
}

TEST(Creases, OfARegionWithoutFacesAreWarnedOf) {
  FaceRegion nowhere = divided("nowhere", 40);
  nowhere.ball = {{9, 9, 9}, 1};
  const TetMesh made = mesh_of(block(), request_of({nowhere, divided("side", 40)}, 0.1));
  EXPECT_THAT(empty_face_regions(made.header, count_faces(made)), ElementsAre("nowhere"));
  const TetMesh all = mesh_of(block(), request_of({divided("side", 40)}, 0.1));
  EXPECT_THAT(empty_face_regions(all.header, count_faces(all)), IsEmpty());
}

TEST(Creases, LeaveTheirNameToWhatIsTooSmallToHaveAny) {
  test::SceneWriter writer;
  const std::string large = writer.add(scene::Sphere{1});
  const std::string small = writer.add(scene::Sphere{0.11});
  const std::string moved = writer.add_moved({1.5, 0, 0}, small);
  writer.add(scene::Combination{scene::Combine::kUnion, {large, moved}, 0});
  const auto counts =
      counts_by_name(mesh_of(scene_shape(writer), request_of({divided("skin", 40)}, 0.1)));
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_GT(counts.at("skin.1"), 20 * counts.at("skin"));
}

TEST(Creases, AreRefusedWhereTheyMakeMorePatchesThanThereAreLabels) {
  const auto from_middle = [](int i) { return (i % 6 + 6) % 6 - 3; };
  const Volume balls =
      test::dense_volume({{0, 0, 0}, {65, 59, 59}}, 3, [&](const VoxelCoord& voxel) {
        const double x = from_middle(voxel.x), y = from_middle(voxel.y),
                     z = from_middle(voxel.z);
        return static_cast<float>(std::hypot(x, y, z) - 2);
      });
  const auto refused =
      try_to_mesh(std::make_shared<const Volume>(balls), request_of({divided("s", 180)}, 1));
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.status().message()),
              AllOf(HasSubstr("face_regions: creases of 180 degrees divide 's' into 1100 "),
                    HasSubstr("the limit is 1024. Use a larger angle")));
}

TEST(Creases, AreRefusedWhereTheirMemoryIsOverTheLimit) {
  const MeshRequest request = request_of({divided("side", 40)}, 0.05);
  MeshRequest undivided = request;
  ask_for_counts(undivided);
  EXPECT_TRUE(undivided.face_regions.empty());
  const MeshLimits limits{.max_plan_bytes = 1'000'000};
  const auto without = try_to_mesh(block(), undivided, limits);
  ASSERT_TRUE(without.ok()) << without.status();
  const auto with = try_to_mesh(block(), request, limits);
  EXPECT_EQ(with.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(with.status().message()), HasSubstr("at creases would take"));
}

}  // namespace
}  // namespace tet::creases_test
