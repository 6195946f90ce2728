// Level sets of several grids, and parts of scenes, as labels of one mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/plan/make/mesher.h"
#include "core/scene/scene.h"
#include "tests/core/labels/label_meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/grid_scenes.h"
#include "tests/support/scenes.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A level set of a ball, of voxels of 0.1 in a band of 3 on either side.
std::shared_ptr<const Volume> ball_at(double x,
                                      double radius,
                                      const std::string& name,
                                      const VoxelTransform& turned = test::scaled(0.1)) {
  const auto value = [&](VoxelCoord v) {
    const WorldPoint p = turned.to_world({1.0 * v.x, 1.0 * v.y, 1.0 * v.z});
    const double distance = std::hypot(p.x - x, p.y, p.z) - radius;
    return static_cast<float>(std::clamp(distance, -0.3, 0.3));
  };
  Volume volume = test::dense_volume({{-32, -32, -32}, {31, 31, 31}}, 0.3F, value, turned);
  volume.name = name;
  return std::make_shared<const Volume>(std::move(volume));
}

/// Turned about z, with the first axis along (0.6, 0.8).
VoxelTransform turned() {
  VoxelTransform transform = test::scaled(0.1);
  transform.linear = {{{0.06, -0.08, 0}, {0.08, 0.06, 0}, {0, 0, 0.1}}};
  return transform;
}

std::shared_ptr<const Scene> shared(const test::SceneWriter& writer) {
  return std::make_shared<const Scene>(writer.scene());
}

std::string add_box(test::SceneWriter& writer, Triple size, Triple at) {
  return writer.add_moved(at, writer.add(scene::RoundedBox{size, 0}));
}

std::string add_ball(test::SceneWriter& writer, double radius, Triple at) {
  return writer.add_moved(at, writer.add(scene::Sphere{radius}));
}

Shape union_of(test::SceneWriter& writer, const std::vector<std::string>& parts) {
  writer.add(scene::Combination{scene::Combine::kUnion, parts, 0});
  return shared(writer);
}

MeshRequest solid_request(const LabelChoice& choice, double spacing = 0.1) {
  MeshRequest request;
  request.levels = 1;
  request.spacing = spacing;
  request.labels = choice;
  return request;
}

absl::StatusOr<MeshResult> mesh_solids(const Shape& shape,
                                       const MeshRequest& request,
                                       int threads = 2) {
  TaskPool pool(threads);
  return mesh_volume(pool, {.shape = shape, .request = request});
}

/// An empty mesh, and a failed test, where there is no sound one.
MeshResult sound_mesh(const Shape& shape, const MeshRequest& request) {
  auto made = mesh_solids(shape, request);
  EXPECT_TRUE(made.ok()) << made.status();
  if (!made.ok()) return {};
  const ConformityReport report = check_conformity(made->mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  const AngleBounds bounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat32);
  EXPECT_GT(made->quality.min_dihedral_deg, bounds.min_deg);
  EXPECT_LT(made->quality.max_dihedral_deg, bounds.max_deg);
  return *std::move(made);
}

/// By the labels' values, those that have tets.
std::map<std::int64_t, test::LabelPart> parts_of(const MeshResult& made) {
  std::map<std::int64_t, test::LabelPart> parts;
  for (const auto& [number, part] : test::parts_of(made.mesh)) {
    parts[made.mesh.header.labels[number].value] = part;
  }
  return parts;
}

std::string solid_refusal(const Shape& shape, const MeshRequest& request) {
  return std::string(mesh_solids(shape, request).status().message());
}

double ball_volume(double radius) { return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3); }

/// The volume of a cap of a ball of radius 1.
double cap_volume(double height) {
  return std::numbers::pi * height * height * (3 - height) / 3;
}

TEST(LevelSetLabels, OfBallsThatOverlapMeetHalfWay) {
  for (const bool is_turned : {false, true}) {
    SCOPED_TRACE(is_turned ? "on two lattices" : "on one lattice");
    const GridList balls{ball_at(0, 1, "water"),
                         ball_at(1.5, 1, "oil", is_turned ? turned() : test::scaled(0.1))};
    const MeshResult made = sound_mesh(balls, solid_request({}));
    const auto parts = parts_of(made);
    ASSERT_EQ(parts.size(), 2U);
    const double each = ball_volume(1) - cap_volume(0.25);
    EXPECT_NEAR(parts.at(1).volume, each, 0.01 * each);
    EXPECT_NEAR(parts.at(2).volume, each, 0.01 * each);
    EXPECT_THAT(made.mesh.header.labels,
                ElementsAre(MeshLabel{1, "water"}, MeshLabel{2, "oil"}));
  }
}

TEST(LevelSetLabels, LieWhereTheLargestNegativeOneSays) {
  // The inner ball is as deep as the outer one only where both bands have ended, within 0.2 of
  // the centre: there the first has it.
  const GridList balls{ball_at(0, 0.5, "small"), ball_at(0, 1, "large")};
  const auto parts = parts_of(sound_mesh(balls, solid_request({})));
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_LT(parts.at(1).volume, ball_volume(0.2));
  EXPECT_NEAR(parts.at(1).volume + parts.at(2).volume, ball_volume(1), 0.01 * ball_volume(1));
}

TEST(LevelSetLabels, AreChosenMergedAndNamedAsAnyLabels) {
  const GridList balls{ball_at(-1.4, 0.6, "a"), ball_at(0, 0.6, "b"), ball_at(1.4, 0.6, "c")};
  MeshRequest request = solid_request({.only = {{1, 1}, {3, 3}}, .names = {{3, "drop"}}});
  const MeshResult some = sound_mesh(balls, request);
  EXPECT_THAT(some.mesh.header.labels, ElementsAre(MeshLabel{1, "a"}, MeshLabel{3, "drop"}));
  EXPECT_EQ(parts_of(some).size(), 2U);
  const auto merged =
      parts_of(sound_mesh(balls, solid_request({.merges = {{{1, 1}, {3, 3}}}})));
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_NEAR(merged.at(1).volume, 2 * ball_volume(0.6), 0.04 * ball_volume(0.6));
}

TEST(LevelSetLabels, HaveTheBackgroundAroundThemUpToTheBox) {
  MeshRequest request = solid_request({.mesh_background = true});
  request.box = WorldBox{{-1.6, -1.6, -1.6}, {1.6, 1.6, 1.6}};
  const MeshResult made = sound_mesh(GridList{ball_at(0, 1, "ball")}, request);
  const auto parts = parts_of(made);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(parts.at(1).volume, ball_volume(1), 0.01 * ball_volume(1));
  ASSERT_TRUE(made.mesh.header.box);
  const auto [min, max] = *made.mesh.header.box;
  EXPECT_NEAR(parts.at(0).volume + parts.at(1).volume, std::pow(max.x - min.x, 3), 1e-3);
}

TEST(LevelSetLabels, OfAnyValuesMakeSoundMeshes) {
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE(absl::StrCat("seed ", seed));
    // Some of them lie on one lattice, some do not.
    const GridList grids{test::random_grid(seed), test::random_grid(seed + 10),
                         test::random_grid(seed + 20)};
    sound_mesh(grids, solid_request({}, 0.17));
    sound_mesh(grids, solid_request({.mesh_background = true}, 0.17));
    // Finer, of which each mesh takes four times as long: with and without in turn.
    sound_mesh(grids, solid_request({.mesh_background = seed % 2 == 0}, 0.1));
  }
}

// Half a voxel beyond what is stored, on a lattice of which a brick is narrower than that.
TEST(LevelSetLabels, ReachBeyondTheLastVoxelOnAnyLattice) {
  Volume volume = test::dense_volume({{0, 0, 0}, {7, 7, 7}}, 1, [](VoxelCoord v) {
    return v.x == 0 && v.y == 0 && v.z == 0 ? -1.0F : 1.0F;
  });
  volume.name = "speck";
  const GridList speck{std::make_shared<const Volume>(std::move(volume))};
  const MeshResult made = sound_mesh(speck, solid_request({}, 0.05));
  double least = 0;
  for (std::uint64_t i = 0; i < made.mesh.header.vertex_count; ++i) {
    least = std::min(least, made.mesh.vertex(i).x);
  }
  EXPECT_NEAR(least, -0.5, 0.01);
}

TEST(LevelSetLabels, AreRefusedInABoxTooFarAwayForTheirVoxels) {
  MeshRequest request = solid_request({}, 25.6);
  const double far = std::ldexp(25.6, 27);
  request.box = WorldBox{{far, 0, 0}, {far + 200, 200, 200}};
  EXPECT_THAT(solid_refusal(GridList{ball_at(0, 1, "ball")}, request),
              HasSubstr("Use a nearer box"));
}

TEST(SceneLabels, HaveWhatEarlierOnesLeave) {
  test::SceneWriter writer;
  const std::string core = add_ball(writer, 0.5, {0, 0, 0});
  const std::string shell = add_ball(writer, 1, {0, 0, 0});
  const Shape shape = union_of(writer, {core, shell});
  const MeshResult made = sound_mesh(shape, solid_request({}, 0.05));
  const auto parts = parts_of(made);
  ASSERT_EQ(parts.size(), 2U);
  const double small = ball_volume(0.5), large = ball_volume(1);
  EXPECT_NEAR(parts.at(1).volume, small, 0.01 * small);
  EXPECT_NEAR(parts.at(2).volume, large - small, 0.01 * large);
  EXPECT_THAT(made.mesh.header.labels, ElementsAre(MeshLabel{1, core}, MeshLabel{2, shell}));
}

TEST(SceneLabels, OfTheOtherOrderLeaveTheLastOneNothing) {
  test::SceneWriter writer;
  const std::string core = add_ball(writer, 0.5, {0, 0, 0});
  const std::string shell = add_ball(writer, 1, {0, 0, 0});
  const auto parts = parts_of(sound_mesh(union_of(writer, {shell, core}), solid_request({})));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_NEAR(parts.at(1).volume, ball_volume(1), 0.01 * ball_volume(1));
}

TEST(SceneLabels, ThatTouchShareTheirFacesWithNothingBetween) {
  // Faces at places that no binary number has, on the lattice's nodes and off them.
  for (const double spacing : {0.1, 0.093}) {
    SCOPED_TRACE(spacing);
    test::SceneWriter writer;
    const std::string left = add_box(writer, {0.7, 1.1, 1.1}, {-0.35, 0, 0});
    const std::string right = add_box(writer, {0.9, 1.1, 1.1}, {0.45, 0, 0});
    const Shape shape = union_of(writer, {left, right});
    MeshRequest request = solid_request({.mesh_background = true}, spacing);
    const MeshResult made = sound_mesh(shape, request);
    const auto parts = parts_of(made);
    ASSERT_EQ(parts.size(), 3U);
    // Edges and corners are cut off by up to a cell.
    EXPECT_NEAR(parts.at(1).volume, 0.7 * 1.1 * 1.1, 0.03);
    EXPECT_NEAR(parts.at(2).volume, 0.9 * 1.1 * 1.1, 0.03);
    // No vertex of the background lies within the face that they share.
    for (std::uint64_t t = 0; t < made.mesh.header.tet_count; ++t) {
      if (made.mesh.header.labels[made.mesh.label(t)].value != 0) continue;
      for (const WorldPoint& p : made.mesh.view().stored_places(t)) {
        const WorldPoint o = made.mesh.header.origin;
        const bool is_within = std::abs(p.x + o.x) < 1e-4 && std::abs(p.y + o.y) < 0.4 &&
                               std::abs(p.z + o.z) < 0.4;
        ASSERT_FALSE(is_within);
      }
    }
  }
}

TEST(SceneLabels, OfOneSolidAreTheMeshOfBothSides) {
  test::SceneWriter writer;
  writer.add(scene::Torus{1, 0.4});
  const auto scene = shared(writer);
  MeshRequest request = solid_request({.mesh_background = true}, 0.11);
  request.box = WorldBox{{-1.7, -1.7, -0.9}, {1.7, 1.7, 0.9}};
  const MeshResult labels = sound_mesh(scene, request);
  request.labels.reset();
  request.preset = Preset::kBothSides;
  const auto sides = mesh_solids(scene, request);
  ASSERT_TRUE(sides.ok()) << sides.status();
  EXPECT_EQ(labels.mesh.header.tet_count, sides->mesh.header.tet_count);
  EXPECT_TRUE(std::ranges::equal(labels.mesh.positions.bytes(), sides->mesh.positions.bytes()));
}

TEST(SceneLabels, OfRandomSolidsMakeSoundMeshesOfTheSameBytes) {
  for (std::uint32_t seed = 1; seed < 6; ++seed) {
    SCOPED_TRACE(absl::StrCat("seed ", seed));
    scene::Description description;
    std::vector<std::string> parts;
    for (std::uint32_t i = 0; i < 3; ++i) {
      for (scene::Node& node : test::random_scene(10 * seed + i).nodes) {
        const std::string prefix = absl::StrCat("s", i, "_");
        node.name = prefix + node.name;
        std::visit(
            [&](auto& kind) {
              if constexpr (requires { kind.of.front().front(); }) {
                for (std::string& of : kind.of) of = prefix + of;
              } else if constexpr (requires { kind.of; }) {
                kind.of = prefix + kind.of;
              }
            },
            node.kind);
        description.nodes.push_back(std::move(node));
      }
      parts.push_back(description.nodes.back().name);
    }
    description.nodes.push_back({"all", scene::Combination{scene::Combine::kUnion, parts, 0}});
    auto scene = make_scene(description);
    ASSERT_TRUE(scene.ok()) << scene.status();
    const Shape shape = std::make_shared<const Scene>(*std::move(scene));
    MeshRequest request = solid_request({.mesh_background = true}, 0.13);
    request.box = WorldBox{{-2, -2, -2}, {2, 2, 2}};
    const MeshResult one = sound_mesh(shape, request);
    const auto three = mesh_solids(shape, request, 3);
    ASSERT_TRUE(three.ok());
    const ConstColumns a = one.mesh.columns(), b = three->mesh.columns();
    EXPECT_TRUE(std::ranges::equal(a.positions, b.positions));
    EXPECT_TRUE(std::ranges::equal(a.tets, b.tets));
    EXPECT_TRUE(std::ranges::equal(a.regions, b.regions));
  }
}

TEST(SceneLabels, AreRefusedWithWhatToDo) {
  test::SceneWriter blended;
  const std::string a = add_ball(blended, 1, {0, 0, 0}), b = add_ball(blended, 1, {1, 0, 0});
  blended.add(scene::Combination{scene::Combine::kUnion, {a, b}, 0.1});
  EXPECT_THAT(solid_refusal(shared(blended), solid_request({})), HasSubstr("union.smoothing"));
  test::SceneWriter ball;
  ball.add(scene::Sphere{1});
  EXPECT_THAT(solid_refusal(shared(ball), solid_request({.smooth = 1})), HasSubstr("smooth"));
  EXPECT_THAT(solid_refusal(shared(ball), solid_request({.only = {{2, 2}}})),
              HasSubstr("the scene has no such label: it has 1"));
  test::SceneWriter endless;
  endless.add(scene::HalfSpace{{0, 0, 1}, 0});
  EXPECT_THAT(solid_refusal(shared(endless), solid_request({})), HasSubstr("has no end"));
}

/// The longest edge of each label's tets, by value.
std::map<std::int64_t, double> longest_edges(const TetMesh& mesh) {
  std::map<std::int64_t, double> longest;
  for (std::uint64_t t = 0; t < mesh.header.tet_count; ++t) {
    const auto corner = mesh.view().stored_places(t);
    double& most = longest[mesh.header.labels[mesh.label(t)].value];
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        most = std::max(most, std::hypot(corner[i].x - corner[k].x, corner[i].y - corner[k].y,
                                         corner[i].z - corner[k].z));
      }
    }
  }
  return longest;
}

TEST(LabelSizes, HoldWithinEachLabelAlone) {
  test::SceneWriter writer;
  const std::string left = add_box(writer, {3, 3, 3}, {-1.5, 0, 0}),
                    right = add_box(writer, {3, 3, 3}, {1.5, 0, 0});
  const Shape shape = union_of(writer, {left, right});
  MeshRequest request = solid_request({.sizes = {{{1, 1}, 0.1}}}, 0.05);
  request.levels = kMaxLevels;
  const MeshResult made = sound_mesh(shape, request);
  const auto longest = longest_edges(made.mesh);
  // An edge of a leaf's tets is as long as the leaf at most.
  EXPECT_LE(longest.at(1), 0.1001);
  EXPECT_GT(longest.at(2), 0.39);
  // Interfaces are what they are without.
  request.labels->sizes.clear();
  const auto without = parts_of(sound_mesh(shape, request)), with = parts_of(made);
  EXPECT_NEAR(without.at(1).volume, with.at(1).volume, 1e-4);
  EXPECT_LT(without.at(1).tets, 0.9 * static_cast<double>(with.at(1).tets));
}

TEST(LabelSizes, AreTheSmallestOfThoseThatHold) {
  test::SceneWriter writer;
  add_box(writer, {3, 3, 3}, {0, 0, 0});
  MeshRequest request =
      solid_request({.sizes = {{kEveryLabel, 0.25}, {{1, 1}, 0.1}, {{1, 1}, 0.5}}}, 0.05);
  request.levels = kMaxLevels;
  EXPECT_LE(longest_edges(sound_mesh(shared(writer), request).mesh).at(1), 0.1001);
  request.labels->sizes = {{kEveryLabel, 0.39}};
  EXPECT_LE(longest_edges(sound_mesh(shared(writer), request).mesh).at(1), 0.2001);
}

TEST(LabelSizes, AreRefusedWithTheirValueAndTheLimit) {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  const auto refusal = [&](std::vector<LabelSize> sizes) {
    return solid_refusal(shared(writer), solid_request({.sizes = std::move(sizes)}));
  };
  EXPECT_THAT(refusal({{{1, 1}, 0.05}}), HasSubstr("sizes[0].size 0.05 is below the spacing"));
  EXPECT_THAT(refusal({{{1, 1}, 1}, {{5, 6}, 1}}), HasSubstr("sizes[1].labels names 5:6"));
  EXPECT_THAT(refusal({{{1, 1}, -1}}), HasSubstr("sizes[0].size -1 is not from"));
  EXPECT_THAT(refusal({{{2, 1}, 1}}), HasSubstr("its first value must not be above its last"));
  EXPECT_THAT(refusal(std::vector<LabelSize>(kMaxLabelSizes + 1, LabelSize{{1, 1}, 1})),
              HasSubstr("the limit is 1024"));
}

}  // namespace
}  // namespace tet
