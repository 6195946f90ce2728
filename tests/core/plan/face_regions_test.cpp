// Pieces of the surface that a request names, against what each face's own corners say.
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/face_counts.h"
#include "core/mesh/find_faces.h"
#include "core/scene/scene.h"
#include "tests/core/plan/mesh_by_chunks.h"
#include "tests/core/plan/meshing.h"
#include "tests/core/plan/some_face_regions.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::face_regions_test {
namespace {

using test::mesh_by_chunks;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNothing = 1e-6;  ///< spacings; no face is told from one this far away

MeshRequest with_regions(std::vector<FaceRegion> regions, MeshRequest request = {}) {
  request.faces = true;
  request.face_regions = std::move(regions);
  return request;
}

absl::StatusOr<MeshResult> try_mesh(const Shape& shape,
                                    const MeshRequest& request,
                                    int threads = 2) {
  TaskPool pool(threads);
  return mesh_volume(pool, {.shape = shape, .request = request});
}

TetMesh mesh(const Shape& shape, const MeshRequest& request, int threads = 2) {
  auto made = try_mesh(shape, request, threads);
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? std::move(made->mesh) : TetMesh();
}

Shape shape_of(Volume volume) { return std::make_shared<const Volume>(std::move(volume)); }

/// A plate with a bore along z and two drilled holes: 4 x 2 x 0.5 world units.
Shape plate() {
  scene::RoundedBox block;
  block.size = {4, 2, 0.5};
  scene::Repeat two;
  test::SceneWriter writer;
  const std::string body = writer.add(block);
  const std::string bore = writer.add(scene::Cylinder{0.4, 2});
  const std::string drill = writer.add(scene::Cylinder{0.2, 2});
  two.of = writer.add_moved({-1.5, 0, 0}, drill);
  two.count = {2, 1, 1};
  two.step = {3, 0, 0};
  const std::string holes = writer.add(two);
  writer.add(scene::Combination{scene::Combine::kDifference, {body, bore, holes}, 0});
  return std::make_shared<const Scene>(writer.scene());
}
const std::string kBody = "0", kBore = "1", kDrill = "2", kHoles = "4";

MeshRequest fine(double spacing = 0.1) {
  MeshRequest request;
  request.spacing = spacing;
  return request;
}

struct FaceView {
  std::string label;
  WorldPoint middle;
  std::array<WorldPoint, 3> corner;
};

std::vector<FaceView> faces_of(const TetMesh& mesh) {
  std::vector<FaceView> faces;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    FaceView& face = faces.emplace_back();
    face.label = mesh.header.face_labels.at(mesh.face_label(i)).name;
    for (std::size_t k = 0; k < 3; ++k) {
      face.corner[k] = mesh.vertex(mesh.face(i)[k]);
      face.middle.x += face.corner[k].x / 3;
      face.middle.y += face.corner[k].y / 3;
      face.middle.z += face.corner[k].z / 3;
    }
  }
  return faces;
}

std::map<std::string, std::uint64_t> count_by_label(const TetMesh& mesh) {
  std::map<std::string, std::uint64_t> counts;
  for (const FaceView& face : faces_of(mesh)) ++counts[face.label];
  return counts;
}

/// How far inside of its region a face's middle lies; negative outside.
using Depth = std::function<double(const FaceView&)>;

/// Looks at every face of one region, and that there are some on either side.
void expect_region(const Shape& shape,
                   MeshRequest request,
                   const FaceRegion& region,
                   const Depth& depth) {
  request.coordinates = CoordinateType::kFloat64;
  const TetMesh made = mesh(shape, with_regions({region}, request));
  std::size_t in = 0, out = 0;
  for (const FaceView& face : faces_of(made)) {
    if (made.header.spacing * kNothing > std::abs(depth(face))) continue;
    ASSERT_EQ(face.label == region.name, depth(face) > 0)
        << face.middle.x << " " << face.middle.y << " " << face.middle.z;
    ++(depth(face) > 0 ? in : out);
  }
  EXPECT_GT(in, 10U);
  EXPECT_GT(out, 10U);
}

double distance(const WorldPoint& a, const WorldPoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(FaceRegions, OfABoxHaveTheFacesWhoseMiddleLiesInIt) {
  expect_region(plate(), fine(), in_box("left", {-3, -1, -1}, {-1.03, 1.5, 1}),
                [](const FaceView& face) { return -1.03 - face.middle.x; });
}

TEST(FaceRegions, OfABallHaveTheFacesWithinItsRadius) {
  FaceRegion region{"round"};
  region.ball = {{1.5, 0, 0.2}, 0.77};
  expect_region(plate(), fine(), region, [](const FaceView& face) {
    return 0.77 - distance(face.middle, {1.5, 0, 0.2});
  });
}

TEST(FaceRegions, OfACylinderEndAtThePlanesAcrossItsEnds) {
  FaceRegion region{"bore"};
  region.cylinder = {{0, 0, -0.21}, {0, 0, 0.23}, 0.45};
  expect_region(plate(), fine(), region, [](const FaceView& face) {
    const auto [x, y, z] = face.middle;
    return std::min({0.45 - std::hypot(x, y), z + 0.21, 0.23 - z});
  });
}

TEST(FaceRegions, OfAHalfSpaceLieBehindItsPlaneWhateverTheNormalsLength) {
  FaceRegion region{"corner"};
  region.half_space = {{0, 30, 40}, 0.31};
  expect_region(plate(), fine(), region, [](const FaceView& face) {
    return 0.31 - (0.6 * face.middle.y + 0.8 * face.middle.z);
  });
}

TEST(FaceRegions, FacingADirectionHaveNormalsOutwardsNearIt) {
  FaceRegion region{"top"};
  region.facing = {{0, 0, 2}, 30};
  const auto depth = [](const FaceView& face) {
    const auto& [a, b, c] = face.corner;
    const Vector normal =
        cross(Vector{b.x - a.x, b.y - a.y, b.z - a.z}, Vector{c.x - a.x, c.y - a.y, c.z - a.z});
    return normal.z / std::sqrt(dot(normal, normal)) - std::cos(std::numbers::pi / 6);
  };
  expect_region(plate(), fine(), region, depth);
  VoxelTransform mirrored;
  mirrored.linear = {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  expect_region(shape_of(test::ball(9, mirrored)), {}, region, depth);
}

TEST(FaceRegions, NearestToPointsShareTheSurfaceAmongThem) {
  FaceRegion left{"left"}, right{"right"};
  left.nearest = {{-2, 0, 0}, {-1, 5, 0}};
  right.nearest = {{1.9, 0, 0}};
  const TetMesh made = mesh(plate(), with_regions({left, right}, fine()));
  const auto counts = count_by_label(made);
  EXPECT_EQ(counts.size(), 2U) << "nothing is left";
  for (const FaceView& face : faces_of(made)) {
    const double to_left = std::min(distance(face.middle, left.nearest[0]),
                                    distance(face.middle, left.nearest[1]));
    const double to_right = distance(face.middle, right.nearest[0]);
    if (std::abs(to_left - to_right) < 1e-5) continue;
    ASSERT_EQ(face.label, to_left < to_right ? "left" : "right");
  }
}

TEST(FaceRegions, OfANodeAreTheFacesThatItMade) {
  const TetMesh made = mesh(
      plate(), with_regions({of_node("bore", kBore), of_node("drilled", kDrill)}, fine(0.05)));
  const auto counts = count_by_label(made);
  EXPECT_EQ(counts.size(), 3U);
  // Edges are not sharp: there a face may have a corner on either side.
  const auto is_on = [](const WorldPoint& p, double x, double radius) {
    return std::abs(std::hypot(p.x - x, p.y) - radius) < 0.03;
  };
  for (const FaceView& face : faces_of(made)) {
    const bool in_bore = is_on(face.middle, 0, 0.4);
    const bool in_hole = is_on(face.middle, -1.5, 0.2) || is_on(face.middle, 1.5, 0.2);
    EXPECT_TRUE(face.label != "bore" || in_bore);
    EXPECT_TRUE(face.label != "drilled" || in_hole);
    if (std::abs(face.middle.z) > 0.2) continue;
    EXPECT_EQ(face.label, in_bore ? "bore" : in_hole ? "drilled" : "surface");
  }
  const auto of_holes = count_by_label(mesh(
      plate(), with_regions({of_node("bore", kBore), of_node("holes", kHoles)}, fine(0.05))));
  EXPECT_EQ(of_holes.at("holes"), counts.at("drilled")) << "both copies";
  const auto of_body =
      count_by_label(mesh(plate(), with_regions({of_node("body", kBody)}, fine(0.05))));
  EXPECT_EQ(of_body.at("body"), counts.at("surface"));
}

TEST(FaceRegions, AreTakenByTheFirstThatFitsAndMergeWhereTheyHaveOneName) {
  const FaceRegion low = in_box("ends", {-3, -2, -1}, {-1, 2, 1});
  const FaceRegion high = in_box("ends", {1, -2, -1}, {3, 2, 1});
  const FaceRegion all = in_box("rest", {-3, -2, -1}, {3, 2, 1});
  const TetMesh made = mesh(plate(), with_regions({low, all, high}, fine()));
  EXPECT_EQ(made.header.face_labels.size(), 3U);
  for (const FaceView& face : faces_of(made)) {
    if (std::abs(std::abs(face.middle.x) - 1) < 1e-5) continue;
    ASSERT_EQ(face.label, face.middle.x < -1 ? "ends" : "rest");
  }
  const auto both = count_by_label(mesh(plate(), with_regions({low, high, all}, fine())));
  EXPECT_NEAR(static_cast<double>(both.at("ends")),
              2 * static_cast<double>(count_by_label(made).at("ends")), 2);
}

TEST(FaceRegions, MeetAllTheirConditions) {
  FaceRegion region = in_box("rim", {-3, -2, -1}, {0.03, 2, 1});
  region.facing = {{0, 0, -1}, 45};
  region.node = kBody;
  for (const FaceView& face : faces_of(mesh(plate(), with_regions({region}, fine())))) {
    if (face.label != "rim") continue;
    EXPECT_LE(face.middle.x, 0.03 + 1e-6);
    EXPECT_LT(face.middle.z, -0.2);
  }
}

TEST(FaceRegions, AreTheSameForAnyThreadsAndChunks) {
  FaceRegion top{"top"};
  top.facing = {{0, 0, 1}, 20};
  const MeshRequest request = with_regions(
      {of_node("bore", kBore), top, in_box("left", {-3, -3, -3}, {0, 3, 3})}, fine(0.06));
  const TetMesh one = mesh(plate(), request, 1);
  EXPECT_TRUE(test::same_bytes(one, mesh(plate(), request, 3)));
  EXPECT_TRUE(test::same_bytes(one, mesh_by_chunks(plate(), request, 1 << 14)));
}

TEST(FaceRegions, LeaveAllElseAsItIs) {
  MeshRequest plain = fine();
  plain.faces = true;
  TetMesh made = mesh(plate(), with_regions({of_node("bore", kBore)}, fine()));
  const TetMesh without = mesh(plate(), plain);
  EXPECT_EQ(made.header.face_labels.back().kind, FaceKind::kRegion);
  std::ranges::copy(without.face_labels.bytes(), made.face_labels.bytes().begin());
  EXPECT_TRUE(test::same_bytes(made, without));
}

TEST(FaceRegions, GoWithCutsAndGradedSurfacesAndWithImprovement) {
  const std::vector<FaceRegion> regions{of_node("bore", kBore),
                                        in_box("left", {-3, -3, -3}, {-0.7, 3, 3})};
  MeshRequest cut = with_regions(regions, fine());
  cut.box = WorldBox{{-3, -3, -3}, {3, 0, 3}};
  const auto cut_counts = count_by_label(mesh(plate(), cut));
  EXPECT_GT(cut_counts.at("bore"), 10U);
  EXPECT_GT(cut_counts.at("left"), 10U);
  EXPECT_GT(cut_counts.at("cut_y_max"), 10U) << "what lies in the box's faces keeps that name";
  MeshRequest graded = with_regions(regions, fine(0.05));
  graded.sizing.grade_surface = true;
  graded.sizing.coarsest = 0.2;
  const TetMesh of_graded = mesh(plate(), graded);
  EXPECT_GT(count_by_label(of_graded).at("bore"), 10U);
  EXPECT_TRUE(test::same_bytes(of_graded, mesh_by_chunks(plate(), graded, 1 << 14)));
  MeshRequest improved = with_regions(regions, fine());
  const TetMesh before = mesh(plate(), improved);
  improved.improve = true;
  const TetMesh after = mesh(plate(), improved);
  EXPECT_TRUE(std::ranges::equal(before.face_labels.bytes(), after.face_labels.bytes()))
      << "a face keeps the name of where it lay";
  EXPECT_TRUE(test::same_bytes(after, mesh_by_chunks(plate(), improved, 1 << 14)));
}

TEST(FaceRegions, OfBothSidesArePiecesOfTheInterface) {
  MeshRequest request = with_regions({in_box("half", {-20, -20, -20}, {0.3, 20, 20})});
  request.preset = Preset::kBothSides;
  const TetMesh made = mesh(shape_of(test::ball(9)), request);
  EXPECT_EQ(made.header.face_labels.size(), 8U);
  for (const FaceView& face : faces_of(made)) {
    if (std::abs(face.middle.x - 0.3) < 1e-5 || face.label.starts_with("box_")) continue;
    ASSERT_EQ(face.label, face.middle.x < 0.3 ? "half" : "interface");
  }
}

TEST(FaceRegions, OfSeveralGridsAreNamedByThem) {
  Volume bone = test::ball(12), joint = test::ball(9);
  bone.name = "bone";
  joint.name = "joint";
  joint.transform.translation = {40.3, -7.1, 3.7};
  const Shape grids = GridList{std::make_shared<const Volume>(std::move(bone)),
                               std::make_shared<const Volume>(std::move(joint))};
  const MeshRequest request = with_regions({in_box("near", {-99, -99, -99}, {5.1, 99, 99}),
                                            in_box("far", {99, 99, 99}, {100, 100, 100})});
  const TetMesh made = mesh(grids, request);
  for (const FaceView& face : faces_of(made)) {
    if (std::abs(face.middle.x - 5.1) < 1e-4) continue;
    ASSERT_EQ(face.label.ends_with("near"), face.middle.x < 5.1) << face.label;
  }
  EXPECT_EQ(made.header.face_labels.size(), 6U);
  EXPECT_THAT(empty_face_regions(made.header, count_faces(made)), ElementsAre("far"))
      << "only one grid is near, and none is far";
}

TEST(FaceRegions, AreToldWhereTheyTookNothing) {
  const TetMesh made = mesh(
      plate(),
      with_regions({in_box("all", {-9, -9, -9}, {9, 9, 9}), of_node("bore", kBore)}, fine()));
  EXPECT_THAT(empty_face_regions(made.header, count_faces(made)), ElementsAre("bore"));
  const TetMesh other = mesh(plate(), with_regions({of_node("bore", kBore)}, fine()));
  EXPECT_THAT(empty_face_regions(other.header, count_faces(other)), IsEmpty());
}

TEST(FaceRegions, AreRefusedWhereTheSceneHasNoSuchNode) {
  const auto scene = try_mesh(plate(), with_regions({of_node("bore", "bor")}, fine()));
  EXPECT_THAT(
      std::string(scene.status().message()),
      HasSubstr("face_regions[0].node \"bor\" is no node of the scene, which has 0, 1"));
  const auto grid = try_mesh(shape_of(test::ball(9)), with_regions({of_node("bore", "1")}));
  EXPECT_THAT(std::string(grid.status().message()), HasSubstr("a grid has none"));
}

TEST(FaceRegions, AreRefusedWhereTwoGridsWouldShareAName) {
  Volume one = test::ball(9), other = test::ball(9);
  one.name = "a";
  other.name = "a_b";
  const Shape grids = GridList{std::make_shared<const Volume>(std::move(one)),
                               std::make_shared<const Volume>(std::move(other))};
  const auto refusal = [&](const std::vector<FaceRegion>& regions) {
    return std::string(try_mesh(grids, with_regions(regions)).status().message());
  };
  const auto named = [](std::string name) {
    return in_box(std::move(name), {-1, -1, -1}, {1, 1, 1});
  };
  EXPECT_THAT(refusal({named("b_c"), named("c")}), HasSubstr("both be called 'a_b_c'"));
  EXPECT_EQ(refusal({named("c")}), "");
}

TEST(FaceRegions, AreRefusedWithoutFaces) {
  MeshRequest request = with_regions({of_node("bore", kBore)}, fine());
  request.faces = false;
  EXPECT_THAT(std::string(try_mesh(plate(), request).status().message()),
              HasSubstr("set without faces"));
}

}  // namespace
}  // namespace tet::face_regions_test
