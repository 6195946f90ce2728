// What an improved mesh of labels promises, beside the same mesh without improvement.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/mesh/improve/improve_labels.h"
#include "core/mesh/improve/label_mover.h"
#include "core/mesh/quality.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/scene/scene.h"
#include "core/volume/label_volume.h"
#include "tests/core/labels/label_meshing.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/scenes.h"
#include "tests/support/volume_fixtures.h"

namespace tet::improved_labels_test {
namespace {

using test::label_cases;
using test::LabelCase;
using test::LabelMeshing;
using test::mesh_of;
using test::parts_of;

constexpr BrickBox kBox{{-1, 0, 2}, {-1, 0, 3}};

/// Indicators that have nothing to do with the labels of the nodes.
ValueSlope anything(Label label, const WorldPoint& p) {
  const double a = 0.37 + 0.11 * label, b = 0.21 * label - 0.5, c = 0.9 - 0.07 * (label % 7);
  const double phase = a * p.x + b * p.y + c * p.z + label;
  return {std::sin(phase), {a * std::cos(phase), b * std::cos(phase), c * std::cos(phase)}};
}

/// Cases that know where labels meet, and others with anything for that.
std::vector<LabelCase> cases(std::uint32_t seed) {
  std::vector<LabelCase> all = label_cases(kBox, seed);
  std::erase_if(all, [](const LabelCase& labels) {
    const bool is_random = labels.name.find("random") != std::string::npos;
    return is_random && labels.labels != 3 && labels.name != "1000 random labels";
  });
  for (LabelCase& labels : all) {
    if (labels.functions.indicator == nullptr) labels.functions.indicator = anything;
  }
  return all;
}

double far_of(const WorldPoint& a, const WorldPoint& b) {
  const Vector way = from_to(a, b);
  return std::sqrt(dot(way, way));
}

void expect_no_worse(const TetMesh& improved, const TetMesh& plain) {
  const ConformityReport report = check_conformity(improved);
  EXPECT_TRUE(report.conforming()) << report.describe();
  EXPECT_TRUE(std::ranges::equal(improved.tets.bytes(), plain.tets.bytes()));
  EXPECT_TRUE(std::ranges::equal(improved.regions.bytes(), plain.regions.bytes()));
  const QualityStats before = measure_quality(plain), after = measure_quality(improved);
  constexpr double kRounding = 1e-6;
  EXPECT_GE(after.min_dihedral_deg,
            std::min(before.min_dihedral_deg, kNearMinDihedralDeg) - kRounding);
  EXPECT_LE(after.max_dihedral_deg,
            std::max(before.max_dihedral_deg, kNearMaxDihedralDeg) + kRounding);
  double farthest = 0;
  for (std::uint64_t v = 0; v < plain.header.vertex_count; ++v) {
    farthest =
        std::max(farthest, far_of(plain.stored_position(v), improved.stored_position(v)));
  }
  EXPECT_LE(farthest, (LabelMover::kReach + kRounding) * plain.header.spacing);
}

/// The domain is filled as before, and no vertex of its boundary moves.
void expect_same_domain(const TetMesh& improved, const TetMesh& plain) {
  double before = 0, after = 0;
  for (const auto& [label, part] : parts_of(plain)) before += part.volume;
  for (const auto& [label, part] : parts_of(improved)) after += part.volume;
  EXPECT_NEAR(after, before, 1e-7);
  for (const Triangle& triangle : boundary_triangles(plain)) {
    for (const std::uint64_t v : triangle) {
      ASSERT_EQ(improved.stored_position(v), plain.stored_position(v));
    }
  }
}

/// All that is said of a mesh is said of one, as improving takes a second each.
TEST(ImprovedLabels, AreNeverWorseWhateverTheIndicatorsSay) {
  for (const LabelCase& labels : cases(1)) {
    SCOPED_TRACE(labels.name);
    LabelMeshing how{.domain = kBox, .levels = kMaxLevels, .threads = 1};
    const TetMesh plain = mesh_of(labels.functions, how).mesh;
    how.improve = true;
    const TetMesh improved = mesh_of(labels.functions, how).mesh;
    expect_no_worse(improved, plain);
    expect_same_domain(improved, plain);
    how.threads = 3;
    EXPECT_TRUE(test::same_bytes(improved, mesh_of(labels.functions, how).mesh));
  }
}

/// Nor is what is stored in float32, where label 0 leaves holes. One brick has as many of them
/// in the way of each vertex as two.
TEST(ImprovedLabels, AreNeverWorseAroundWhatIsLeftOut) {
  for (const LabelCase& labels : cases(1)) {
    SCOPED_TRACE(labels.name);
    LabelMeshing how{.domain = {kBox.min, kBox.min}, .kept = {Label{0}}};
    how.coordinates = CoordinateType::kFloat32;
    const TetMesh plain = mesh_of(labels.functions, how).mesh;
    how.improve = true;
    expect_no_worse(mesh_of(labels.functions, how).mesh, plain);
  }
}

/// A nest of three balls, cut in two by a plane, with a sheet one voxel thin on it.
Shape nest(const VoxelTransform& transform = {}) {
  constexpr int kEdge = 24;
  std::vector<std::int64_t> values;
  for (int z = 0; z < kEdge; ++z) {
    for (int y = 0; y < kEdge; ++y) {
      for (int x = 0; x < kEdge; ++x) {
        const double dx = x - 11.3, dy = y - 12.1, dz = z - 11.7;
        const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
        const bool low = x < 11, sheet = x == 11;
        values.push_back(r > 10.5  ? 0
                         : r > 7.5 ? (sheet ? 5 : 1)
                         : r > 4.5 ? (low ? 2 : 3)
                                   : 4);
      }
    }
  }
  auto volume = make_label_volume({.name = "nest",
                                   .transform = transform,
                                   .size = {kEdge, kEdge, kEdge},
                                   .min = {0, 0, 0},
                                   .values = values});
  EXPECT_TRUE(volume.ok()) << volume.status();
  return std::make_shared<const LabelVolume>(*std::move(volume));
}

MeshRequest request_of(const LabelChoice& choice, bool improve) {
  MeshRequest request;
  request.labels = choice;
  request.improve = improve;
  request.levels = 1;
  return request;
}

MeshResult made_of(const Shape& shape, const MeshRequest& request, int threads = 2) {
  TaskPool pool(threads);
  auto made = mesh_volume(pool, {.shape = shape, .request = request});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : MeshResult{};
}

TEST(ImprovedLabels, OfVoxelsAreNoWorseAndKeepTheirVolumes) {
  VoxelTransform uneven;
  uneven.linear = {{{0.4, -0.3, 0}, {0.3, 0.4, 0}, {0, 0, 0.75}}};
  uneven.voxel_size = 0.5;
  for (const VoxelTransform& transform : {VoxelTransform{}, uneven}) {
    for (const LabelChoice& choice :
         {LabelChoice{}, LabelChoice{.mesh_background = true},
          LabelChoice{.kernel = LabelKernel::kQuadratic},
          LabelChoice{.kernel = LabelKernel::kTrilinear}, LabelChoice{.smooth = 1}}) {
      SCOPED_TRACE(testing::Message()
                   << "kernel " << static_cast<int>(choice.kernel) << ", smooth "
                   << choice.smooth << ", edge " << transform.voxel_size);
      const Shape shape = nest(transform);
      const MeshResult plain = made_of(shape, request_of(choice, false));
      const MeshResult improved = made_of(shape, request_of(choice, true));
      expect_no_worse(improved.mesh, plain.mesh);
      ASSERT_TRUE(improved.improvement);
      EXPECT_GT(improved.improvement->moved_vertices, 1000U);
      const auto before = parts_of(plain.mesh), after = parts_of(improved.mesh);
      for (const auto& [label, part] : after) {
        const double whole = before.at(label).volume;
        // The Gaussian leaves crumbs of the sheet, which lies within one label.
        EXPECT_NEAR(part.volume, whole, (label == 4 ? 0.5 : 0.03) * whole) << label;
      }
    }
  }
}

TEST(ImprovedLabels, ReportWhatTheirBytesHaveAndWhatTheyHadBefore) {
  const Shape shape = nest();
  const QualityStats before = made_of(shape, request_of({}, false)).quality;
  const MeshResult improved = made_of(shape, request_of({}, true));
  const QualityStats after = measure_quality(improved.mesh);
  EXPECT_EQ(improved.quality.min_dihedral_deg, after.min_dihedral_deg);
  EXPECT_EQ(improved.quality.max_dihedral_deg, after.max_dihedral_deg);
  EXPECT_EQ(improved.quality.histogram, after.histogram);
  ASSERT_TRUE(improved.improvement);
  EXPECT_NEAR(improved.improvement->min_dihedral_before_deg, before.min_dihedral_deg, 1e-4);
  EXPECT_NEAR(improved.improvement->max_dihedral_before_deg, before.max_dihedral_deg, 1e-4);
}

TEST(ImprovedLabels, AreTheSameWhenTheyComeInChunksWithFaces) {
  const Shape shape = nest();
  MeshRequest request = request_of({}, true);
  request.faces = true;
  const MeshResult whole = made_of(shape, request, 1);
  TaskPool pool(3);
  pool.run([&] {
    const auto plan =
        plan_mesh({.shape = shape, .request = request, .limits = {.chunk_bytes = 1 << 15}});
    ASSERT_TRUE(plan.ok()) << plan.status();
    ASSERT_GT((*plan)->header().chunk_count, 4U);
    ASSERT_TRUE((*plan)->improvement());
    const auto chunks = fill_mesh(**plan, Cancellation(), nullptr);
    ASSERT_TRUE(chunks.ok());
    EXPECT_TRUE(test::same_bytes(chunks->mesh, whole.mesh));
    EXPECT_TRUE(std::ranges::equal(chunks->mesh.faces.bytes(), whole.mesh.faces.bytes()));
    EXPECT_EQ(chunks->quality.histogram, whole.quality.histogram);
  });
}

/// Two balls of radius 1, of which the first is at the origin and the second at x = 1, as
/// solids of a scene, or as level sets with voxels of 0.05.
Shape lens_of_scene() {
  test::SceneWriter writer;
  const std::string first = writer.add(scene::Sphere{1});
  const std::string second = writer.add_moved({1, 0, 0}, writer.add(scene::Sphere{1}));
  writer.add(scene::Combination{scene::Combine::kUnion, {first, second}, 0});
  return std::make_shared<const Scene>(writer.scene());
}

Shape lens_of_level_sets() {
  GridList grids;
  for (const double x : {0.0, 1.0}) {
    const auto value = [&](VoxelCoord v) {
      const double distance = std::hypot(0.05 * v.x - x, 0.05 * v.y, 0.05 * v.z) - 1;
      return static_cast<float>(std::clamp(distance, -0.2, 0.2));
    };
    grids.push_back(std::make_shared<const Volume>(
        test::dense_volume({{-32, -32, -32}, {55, 31, 31}}, 0.2F, value, test::scaled(0.05))));
  }
  return grids;
}

/// The distance of vertices of both balls from the circle where these meet nobody, root mean
/// square.
double far_from_circle(const TetMesh& mesh) {
  std::vector<std::set<Label>> around(mesh.header.vertex_count);
  for (std::uint64_t t = 0; t < mesh.header.tet_count; ++t) {
    for (const std::uint64_t v : mesh.tet(t)) around[v].insert(mesh.label(t));
  }
  std::set<std::uint64_t> outer;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    outer.insert(triangle.begin(), triangle.end());
  }
  double squares = 0;
  std::size_t count = 0;
  for (const std::uint64_t v : outer) {
    if (around[v].size() != 2) continue;
    const WorldPoint p = mesh.vertex(v);
    const double outwards = std::hypot(p.y, p.z) - std::sqrt(0.75);
    squares += (p.x - 0.5) * (p.x - 0.5) + outwards * outwards;
    ++count;
  }
  EXPECT_GT(count, 100U);
  return std::sqrt(squares / static_cast<double>(count));
}

TEST(ImprovedLabels, OfSolidsHaveTheirCurvesWhereTheyBelong) {
  for (const bool of_scene : {true, false}) {
    SCOPED_TRACE(of_scene ? "scene" : "level sets");
    const Shape shape = of_scene ? lens_of_scene() : lens_of_level_sets();
    MeshRequest request = request_of({}, false);
    request.spacing = 0.05;
    const TetMesh plain = made_of(shape, request).mesh;
    request.improve = true;
    const TetMesh improved = made_of(shape, request).mesh;
    expect_no_worse(improved, plain);
    const double before = far_from_circle(plain) / 0.05,
                 after = far_from_circle(improved) / 0.05;
    // The second ball of the scene ends in a wedge of 60 degrees, as the first is whole.
    EXPECT_LT(after, of_scene ? 0.2 : 0.05);
    EXPECT_LT(after, before / 2) << "before " << before;
  }
}

TEST(ImprovedLabels, AreRefusedAsAPlanThatCouldNotHoldThem) {
  MeshLimits limits{.max_plan_bytes = 5'000'000};
  const Shape shape = nest();
  ASSERT_TRUE(
      plan_mesh({.shape = shape, .request = request_of({}, false), .limits = limits}).ok());
  const auto plan =
      plan_mesh({.shape = shape, .request = request_of({}, true), .limits = limits});
  EXPECT_EQ(plan.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(plan.status().message()), testing::HasSubstr("improving"));
}

TEST(ImprovedLabels, StopWhenTheyAreCancelled) {
  Cancellation cancelled;
  cancelled.cancel();
  const auto labels = label_cases(kBox, 4).front();
  TaskPool pool(2);
  pool.run([&] {
    const auto plan = plan_labels(test::label_job(
        std::make_shared<const test::FunctionLabels>(labels.functions), {.domain = kBox}));
    ASSERT_TRUE(plan.ok());
    auto filled = fill_mesh(**plan, Cancellation(), nullptr);
    ASSERT_TRUE(filled.ok());
    const Improvement none = (*plan)->improve(filled->mesh, cancelled);
    EXPECT_EQ(none.moved_vertices, 0U);
  });
}

}  // namespace
}  // namespace tet::improved_labels_test
