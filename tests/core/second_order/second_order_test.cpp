#include "core/second_order/second_order.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/fidelity/surface_triangles.h"
#include "core/field/world_phi.h"
#include "core/plan/make/mesher.h"
#include "core/second_order/curved_edges.h"
#include "core/second_order/measure_curved.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

constexpr double kPi = std::numbers::pi;

struct Curved {
  TetMesh mesh;
  MiddleNodes middles;
};

MiddleNodes middles_of(const TetMesh& mesh,
                       const Shape& shape,
                       const MeshRequest& request,
                       int threads = 2) {
  absl::StatusOr<MiddleNodes> made = absl::UnknownError("not made");
  TaskPool(threads).run([&] { made = make_second_order(mesh, shape, request); });
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : MiddleNodes{};
}

Curved curved(const Shape& shape, const MeshRequest& request) {
  TaskPool pool(2);
  auto made = mesh_volume(pool, {.shape = shape, .request = request});
  EXPECT_TRUE(made.ok()) << made.status();
  if (!made.ok()) return {};
  MiddleNodes middles = middles_of(made->mesh, shape, request);
  return {std::move(made->mesh), std::move(middles)};
}

Shape ball_scene() {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  return std::make_shared<const Scene>(writer.scene());
}

MeshRequest at_spacing(double spacing) {
  MeshRequest request;
  request.spacing = spacing;
  return request;
}

double straight_volume(const TetMesh& mesh) {
  double volume = 0;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const auto p = mesh.view().stored_places(i);
    volume += dot(cross(from_to(p[0], p[1]), from_to(p[0], p[2])), from_to(p[0], p[3])) / 6;
  }
  return volume;
}

/// At the places of a rule that is exact for quintics, and everywhere by the coefficients.
void expect_positive(const Curved& all) {
  EXPECT_GE(measure_curved(all.mesh, all.middles).least_jacobian_share,
            CurvedEdges::kLeastShare - 1e-3);
  std::mt19937 random(1);
  std::exponential_distribution<double> weight(1);
  for (std::uint64_t tet = 0; tet < all.mesh.header.tet_count; ++tet) {
    const TenNodes node = nodes_of(all.mesh, all.middles, tet);
    std::array<double, 4> shares{weight(random), weight(random), weight(random),
                                 weight(random)};
    const double sum = shares[0] + shares[1] + shares[2] + shares[3];
    for (double& share : shares) share /= sum;
    ASSERT_GT(jacobian_at(node, shares), 0) << "tet " << tet;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      std::array<double, 4> at{};
      at[corner] = 1;
      ASSERT_GT(jacobian_at(node, at), 0) << "tet " << tet;
    }
  }
}

TEST(SecondOrder, HasATenthOfABallsVolumeErrorAtMost) {
  const double exact = 4.0 / 3 * kPi;
  for (const double spacing : {0.25, 0.125, 0.0625}) {
    const Curved ball = curved(ball_scene(), at_spacing(spacing));
    const double straight = std::abs(straight_volume(ball.mesh) - exact);
    const double bent = std::abs(measure_curved(ball.mesh, ball.middles).volume - exact);
    EXPECT_LT(bent, straight / 10) << "spacing " << spacing;
    EXPECT_EQ(ball.middles.straightened, 0U) << "spacing " << spacing;
  }
}

TEST(SecondOrder, HasATenthOfTheVolumeErrorInALevelSetToo) {
  const Shape ball = std::make_shared<const Volume>(test::ball(12));
  const double exact = 4.0 / 3 * kPi * 12 * 12 * 12;
  const Curved found = curved(ball, at_spacing(3));
  const double straight = std::abs(straight_volume(found.mesh) - exact);
  EXPECT_LT(std::abs(measure_curved(found.mesh, found.middles).volume - exact), straight / 5)
      << "voxels make the surface flat between them";
}

TEST(SecondOrder, PutsTheMiddlesOfTheSurfacesEdgesOnTheSurface) {
  const Curved ball = curved(ball_scene(), at_spacing(0.1));
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint32_t> middle_of;
  for (std::uint64_t tet = 0; tet < ball.mesh.header.tet_count; ++tet) {
    const auto corners = ball.mesh.tet(tet);
    const auto middles = ball.middles.of_tet(tet);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto edge = std::minmax(corners[kTetEdges[e][0]], corners[kTetEdges[e][1]]);
      const auto [at, is_new] = middle_of.emplace(edge, middles[e]);
      EXPECT_EQ(at->second, middles[e]) << "tets share the node of an edge";
    }
  }
  EXPECT_EQ(middle_of.size(), ball.middles.count) << "each edge has one, and one alone";
  const WorldPoint& origin = ball.mesh.header.origin;
  for (const Triangle& t : surface_triangles(ball.mesh)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto middle = middle_of.at(std::minmax(t[k], t[(k + 1) % 3]));
      const WorldPoint p = ball.middles.stored_position(ball.mesh.header, middle);
      EXPECT_NEAR(std::hypot(origin.x + p.x, origin.y + p.y, origin.z + p.z), 1, 1e-6);
    }
  }
}

TEST(SecondOrder, LeavesInnerEdgesStraight) {
  const Curved ball = curved(ball_scene(), at_spacing(0.1));
  std::vector<bool> on_surface(ball.mesh.header.vertex_count);
  for (const Triangle& t : surface_triangles(ball.mesh)) {
    for (const std::uint64_t vertex : t) on_surface[vertex] = true;
  }
  for (std::uint64_t tet = 0; tet < ball.mesh.header.tet_count; ++tet) {
    const TenNodes node = nodes_of(ball.mesh, ball.middles, tet);
    const auto corners = ball.mesh.tet(tet);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [i, j] = kTetEdges[e];
      if (on_surface[corners[i]] && on_surface[corners[j]]) continue;
      EXPECT_NEAR(node[4 + e].x, (node[i].x + node[j].x) / 2, 1e-6);
      EXPECT_NEAR(node[4 + e].y, (node[i].y + node[j].y) / 2, 1e-6);
      EXPECT_NEAR(node[4 + e].z, (node[i].z + node[j].z) / 2, 1e-6);
    }
  }
}

TEST(SecondOrder, IsPositiveEverywhereInEveryKnownScene) {
  for (const test::KnownScene& known : test::known_scenes()) {
    const Shape shape = std::make_shared<const Scene>(known.scene);
    SCOPED_TRACE(known.name);
    expect_positive(curved(shape, at_spacing(2 * known.spacing)));  // coarse on purpose
  }
}

TEST(SecondOrder, IsPositiveEverywhereInHarshFields) {
  for (const Preset preset : {Preset::kDefault, Preset::kBothSides}) {
    MeshRequest request;
    request.preset = preset;
    for (const std::uint32_t seed : {1U, 2U}) {
      expect_positive(
          curved(std::make_shared<const Volume>(test::random_signs(12, seed, 7)), request));
    }
    expect_positive(curved(std::make_shared<const Volume>(test::gyroid_ball(20)), request));
    expect_positive(curved(std::make_shared<const Volume>(test::tilted_cube(9)), request));
  }
}

/// How far the determinant falls, by the straight one's, in a tet that has a curved edge.
double least_share_of_curved(const Curved& all) {
  double least = 1;
  for (std::uint64_t tet = 0; tet < all.mesh.header.tet_count; ++tet) {
    const TenNodes node = nodes_of(all.mesh, all.middles, tet);
    bool is_curved = false;
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [i, j] = kTetEdges[e];
      is_curved = is_curved ||
                  node[4 + e] != stored_middle(all.mesh.header, node[i], node[j], Vector{});
    }
    if (!is_curved) continue;
    const Vector b = from_to(node[0], node[1]), c = from_to(node[0], node[2]),
                 d = from_to(node[0], node[3]);
    const double straight = dot(cross(b, c), d);
    if (!(straight > 0)) continue;  // its corners are too far away for their digits
    least = std::min(least, least_jacobian(node) / straight);
  }
  return least;
}

// Far from the origin a float32 has few digits left for a bend.
TEST(SecondOrder, BendsNoTetTooFarAsItIsStored) {
  MeshRequest request;
  request.coordinates = CoordinateType::kFloat32;
  for (const double far : {0.0, 3000.0}) {
    request.origin = WorldPoint{far, far, far};
    for (const std::uint32_t seed : {1U, 2U}) {
      const Curved found =
          curved(std::make_shared<const Volume>(test::random_signs(12, seed, 7)), request);
      EXPECT_GT(found.middles.straightened, 0U);
      EXPECT_GE(least_share_of_curved(found), CurvedEdges::kLeastShare - 1e-12)
          << "from an origin " << far << " spacings away";
    }
  }
}

TEST(SecondOrder, CurvesTheInterfaceOfBothSides) {
  MeshRequest request = at_spacing(3);
  request.preset = Preset::kBothSides;
  const Shape ball = std::make_shared<const Volume>(test::ball(12));
  const Curved both = curved(ball, request);
  expect_positive(both);
  EXPECT_GT(both.middles.curved, 100U);
  const double exact = 4.0 / 3 * kPi * 12 * 12 * 12;
  EXPECT_NEAR(measure_curved(both.mesh, both.middles).volume, exact, 0.005 * exact);
}

/// Not at the equator, where phi's slope lies in the box's face anyway.
TEST(SecondOrder, KeepsTheFacesOfABoxFlat) {
  MeshRequest request = at_spacing(0.05);
  request.box = WorldBox{{-2, -2, 0.5}, {2, 2, 2}};
  const Curved cap = curved(ball_scene(), request);
  expect_positive(cap);
  const MeshHeader& header = cap.mesh.header;
  ASSERT_TRUE(header.box);
  const double cut = header.box->min.z;
  EXPECT_GT(cut, 0.15);
  double lowest = 1;
  for (std::uint64_t i = 0; i < cap.middles.count; ++i) {
    lowest = std::min(lowest, cap.middles.stored_position(header, i).z + header.origin.z);
  }
  EXPECT_NEAR(lowest, cut, 1e-6);
  const double exact = kPi * (2.0 / 3 - cut + cut * cut * cut / 3);
  EXPECT_NEAR(measure_curved(cap.mesh, cap.middles).volume, exact,
              std::abs(straight_volume(cap.mesh) - exact) / 5);
}

TEST(SecondOrder, BendsEachOfSeveralGridsToItsOwnSurface) {
  GridList balls;
  double exact = 0;
  for (const double radius : {10.0, 14.0}) {
    Volume ball = test::ball(radius);
    ball.name = radius < 12 ? "small" : "large";
    balls.push_back(std::make_shared<const Volume>(std::move(ball)));
    exact += 4.0 / 3 * kPi * radius * radius * radius;
  }
  const Curved both = curved(balls, at_spacing(3));
  expect_positive(both);
  EXPECT_EQ(both.mesh.header.parts.size(), 2U);
  EXPECT_LT(std::abs(measure_curved(both.mesh, both.middles).volume - exact),
            std::abs(straight_volume(both.mesh) - exact) / 4);
}

TEST(SecondOrder, GoesWithImprovementAndGradedSurfaces) {
  MeshRequest improved = at_spacing(0.2), graded = at_spacing(0.1);
  improved.improve = true;
  graded.sizing.grade_surface = true;
  graded.sizing.coarsest = 0.2;
  for (const MeshRequest& request : {improved, graded}) {
    const Curved ball = curved(ball_scene(), request);
    expect_positive(ball);
    const double exact = 4.0 / 3 * kPi;
    EXPECT_LT(std::abs(measure_curved(ball.mesh, ball.middles).volume - exact),
              std::abs(straight_volume(ball.mesh) - exact) / 10);
  }
}

TEST(SecondOrder, HasTheSameBytesForAnyNumberOfThreads) {
  const Shape shape = std::make_shared<const Volume>(test::gyroid_ball(24));
  TaskPool pool(2);
  const auto made = mesh_volume(pool, {.shape = shape, .request = {}});
  ASSERT_TRUE(made.ok());
  const MiddleNodes one = middles_of(made->mesh, shape, {}, 1);
  const MiddleNodes many = middles_of(made->mesh, shape, {}, 7);
  EXPECT_TRUE(std::ranges::equal(one.positions.bytes(), many.positions.bytes()));
  EXPECT_EQ(one.of_tets, many.of_tets);
}

TEST(SecondOrder, GivesMiddleNodesTheValuesOfFields) {
  Volume heat = test::ball(13);
  heat.kind = VolumeKind::kField;
  MeshRequest request = at_spacing(2);
  request.fields = {
      {.name = "heat", .components = {std::make_shared<const Volume>(std::move(heat))}}};
  const Shape ball = std::make_shared<const Volume>(test::ball(12));
  const Curved found = curved(ball, request);
  ASSERT_EQ(found.middles.fields.size(), found.middles.count * sizeof(float));
  const Volume same = test::ball(13);
  PhiField field;
  field.volume = &same;
  WorldPhi heat_at(field, 1);
  const MeshHeader& header = found.mesh.header;
  for (std::uint64_t i = 0; i < found.middles.count; ++i) {
    const WorldPoint p = found.middles.stored_position(header, i);
    float value = 0;
    std::memcpy(&value, found.middles.fields.bytes().data() + i * sizeof(value), sizeof(value));
    ASSERT_NEAR(
        value,
        heat_at.at({header.origin.x + p.x, header.origin.y + p.y, header.origin.z + p.z}), 1e-4)
        << "node " << i;
  }
  MeshRequest without = request;
  without.fields.clear();
  const MiddleNodes averaged = middles_of(found.mesh, ball, without);
  ASSERT_EQ(averaged.fields.size(), found.middles.fields.size());
  EXPECT_FALSE(std::ranges::equal(averaged.fields.bytes(), found.middles.fields.bytes()))
      << "sampled where the node lies, not averaged";
}

TEST(SecondOrder, NeedsNoGridOfSizes) {
  const Shape ball = ball_scene();
  const Curved found = curved(ball, at_spacing(0.25));
  MeshRequest sized = at_spacing(0.25);
  sized.sizing.grid = SizingGrid{};  // which is loaded no more once the mesh is made
  const MiddleNodes middles = middles_of(found.mesh, ball, sized);
  EXPECT_GT(middles.curved, 0U);
  EXPECT_TRUE(std::ranges::equal(middles.positions.bytes(), found.middles.positions.bytes()));
}

TEST(SecondOrder, OfNothingIsNothing) {
  TetMesh empty{MeshHeader{}};
  const MiddleNodes middles = middles_of(empty, ball_scene(), at_spacing(0.1));
  EXPECT_EQ(middles.count, 0U);
}

}  // namespace
}  // namespace tet
