// What is measured of a plan's chunks, beside the same of the mesh that they make.
#include "core/fidelity/measure_plan.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/prepared_mesh.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

struct Case {
  std::string name;
  Shape shape;
  MeshRequest request;
};

std::shared_ptr<const Volume> ball_of(double radius, const char* name = "ball") {
  Volume volume = test::ball(radius);
  volume.name = name;
  return std::make_shared<const Volume>(std::move(volume));
}

Shape grid_of(double radius) { return ball_of(radius); }

Shape scene() {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  return std::make_shared<const Scene>(writer.scene());
}

std::vector<Case> cases() {
  MeshRequest plain, both, cut, wide;
  for (MeshRequest* request : {&plain, &both, &cut, &wide}) {
    request->faces = request->fidelity = true;
  }
  both.preset = Preset::kBothSides;
  both.improve = true;
  cut.box = WorldBox{{-2, -2, -2}, {2, 2, 0.3}};
  cut.spacing = both.spacing = 0.1;
  both.box = WorldBox{{-2, -2, -2}, {2, 2, 2}};
  wide.coordinates = CoordinateType::kFloat64;
  wide.indices = IndexType::kUint64;
  return {{"plain", grid_of(9.3), plain},
          {"both sides, improved", scene(), both},
          {"cut, so graded", scene(), cut},
          {"wide", grid_of(9.3), wide},
          {"several", GridList{ball_of(6, "small"), ball_of(9.3, "large")}, plain}};
}

MeshFidelity of_plan(const Case& one, int threads, std::size_t chunk_bytes) {
  absl::StatusOr<MeshFidelity> measured = absl::UnknownError("not measured");
  TaskPool(threads).run([&] {
    MeshLimits limits;
    limits.chunk_bytes = chunk_bytes;
    const auto plan = plan_mesh({.shape = one.shape, .request = one.request, .limits = limits});
    ASSERT_TRUE(plan.ok()) << plan.status();
    measured = fidelity_of(**plan, one.request, {});
  });
  EXPECT_TRUE(measured.ok()) << measured.status();
  return measured.ok() ? *measured : MeshFidelity{};
}

MeshFidelity of_mesh(const Case& one) {
  TaskPool pool(2);
  const auto made = mesh_volume(pool, {.shape = one.shape, .request = one.request});
  EXPECT_TRUE(made.ok()) << made.status();
  absl::StatusOr<MeshFidelity> measured = absl::UnknownError("not measured");
  pool.run([&] { measured = fidelity_of(made->mesh, one.shape, one.request); });
  EXPECT_TRUE(measured.ok()) << measured.status();
  return measured.ok() ? *measured : MeshFidelity{};
}

TEST(PlanFidelity, IsThatOfTheMeshToTheLastBitHoweverItIsCut) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const MeshFidelity whole = of_mesh(one);
    ASSERT_FALSE(whole.parts.empty());
    EXPECT_GT(whole.shapes.scaled_jacobian.min, 0);
    EXPECT_GT(whole.parts.front().to_surface.max, 0);
    EXPECT_EQ(of_plan(one, 3, std::size_t{1} << 15), whole);
  }
  const Case plain = cases().front();
  EXPECT_EQ(of_plan(plain, 1, kChunkBytes), of_plan(plain, 2, std::size_t{1} << 14));
}

TEST(PlanFidelity, StopsWhenItIsCancelled) {
  const Case one = cases().front();
  TaskPool(2).run([&] {
    const auto plan = plan_mesh({.shape = one.shape, .request = one.request});
    ASSERT_TRUE(plan.ok()) << plan.status();
    Cancellation cancelled, late(Cancellation::Clock::now());
    cancelled.cancel();
    EXPECT_TRUE(absl::IsCancelled(fidelity_of(**plan, one.request, cancelled).status()));
    EXPECT_TRUE(absl::IsDeadlineExceeded(fidelity_of(**plan, one.request, late).status()));
  });
}

/// What is charged beside what any mesh takes, and beside its faces.
std::uint64_t bytes_for_bricks(const Shape& shape, const MeshRequest& request) {
  constexpr std::uint64_t kOfAny = std::uint64_t{17} << 20, kPerFace = 448;
  std::uint64_t bytes = 0;
  TaskPool(2).run([&] {
    const auto plan = plan_mesh({.shape = shape, .request = request});
    ASSERT_TRUE(plan.ok()) << plan.status();
    const MeshHeader& header = (*plan)->header();
    bytes = fidelity_bytes(**plan, 1) - kOfAny - kPerFace * header.face_count -
            ChunkSizes(header, whole_of(header)).positions;
  });
  return bytes;
}

MeshRequest faces_at(double spacing) {
  MeshRequest request;
  request.faces = request.fidelity = true;
  request.spacing = spacing;
  return request;
}

/// Large leaves have few faces, and their surface is looked for in all finest bricks.
TEST(PlanFidelity, CountsTheBricksOfGradedSurfaces) {
  MeshRequest request = faces_at(0.005);
  request.sizing.grade_surface = true;
  request.sizing.coarsest = 0.1;
  const Shape ball = scene();
  const auto prepared = prepare_mesh(ball, request, {}, {});
  ASSERT_TRUE(prepared.ok()) << prepared.status();
  EXPECT_GT(bytes_for_bricks(ball, request), 140 * prepared->bricks.near_surface.size());
}

TEST(PlanFidelity, CountsTheBricksOfVoxelsWhereTheLatticeIsCoarser) {
  const auto large = ball_of(90, "large");
  for (const Shape& shape : {Shape(large), Shape(GridList{ball_of(30, "small"), large})}) {
    EXPECT_GT(bytes_for_bricks(shape, faces_at(10)), 128 * large->bricks.size());
  }
}

TEST(PlanFidelity, IsOfMeshesThatHaveFaces) {
  MeshRequest request;
  request.fidelity = true;
  TaskPool(1).run([&] {
    const auto plan = plan_mesh({.shape = grid_of(6), .request = request});
    EXPECT_EQ(plan.status().message(),
              "fidelity is set without faces, which are what is measured: set faces");
  });
}

}  // namespace
}  // namespace tet
