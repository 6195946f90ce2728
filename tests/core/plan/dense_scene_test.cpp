// Scenes of which one brick is a second's work: they stop within it.
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/own_threads.h"
#include "core/field/find_scene_bricks.h"
#include "core/field/phi_field.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/fill_watch.h"
#include "core/plan/labelled/solid_request.h"
#include "core/plan/make/plan_mesh.h"
#include "core/scene/scene_evaluator.h"
#include "core/transfer/compact_chunk.h"
#include "tests/support/counted_looks.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"

namespace tet {
namespace {

using test::CountedLooks;

/// Thousands of solids within a brick or two, all of which are evaluated for each: "0", and
/// "1" of it repeated.
std::shared_ptr<const Scene> grains() {
  test::SceneWriter writer;
  scene::Ellipsoid grain;
  grain.semi_axes = {1, 0.7, 0.5};
  scene::Repeat grains;
  grains.of = writer.add(grain);
  grains.count = {16, 16, 4};
  grains.step = {1.9, 1.3, 0.9};
  writer.add(grains);
  return std::make_shared<const Scene>(writer.scene());
}

PhiField field_of(const Scene& scene, double spacing) {
  PhiField field;
  field.scene = &scene;
  field.spacing_voxels = spacing;
  return field;
}

constexpr double kCoarse = 2;
constexpr BrickCoord kDense{0, 0, 0};
/// What a brick and its halo take to be sampled.
constexpr std::size_t kSamples = 13 * 13 * 13 + 12 * 12 * 12;

TEST(DenseScene, LooksWhetherItIsCancelledWithinTheSamplesOfABrick) {
  const auto scene = grains();
  PhiSampler sampler(field_of(*scene, kCoarse));
  CountedLooks never;
  sampler.stop_when(never.cancellation);
  const auto samples = std::make_unique<BrickSamples>();
  sampler.sample(kDense, *samples);
  // At each 2^14 values of an instruction, but for the last few of a column.
  const std::size_t values = sampler.scene().in_focus().size() * kSamples;
  EXPECT_GT(values, std::size_t{1} << 20);
  EXPECT_GT(never.looks, values >> 15);
}

TEST(DenseScene, DoesNothingMoreOfABrickOnceItIsCancelled) {
  const auto scene = grains();
  const auto samples = std::make_unique<BrickSamples>();
  for (const std::size_t most : {std::size_t{0}, std::size_t{1}, std::size_t{20}}) {
    PhiSampler sampler(field_of(*scene, kCoarse));
    CountedLooks cut{most};
    sampler.stop_when(cut.cancellation);
    for (int i = 0; i < 3; ++i) sampler.sample(kDense, *samples);
    EXPECT_EQ(cut.looks, most + 1);  // nobody looks again, however much is asked for
  }
}

TEST(DenseScene, IsTheSameWithSomebodyWhoLooks) {
  const auto scene = grains();
  PhiSampler sampler(field_of(*scene, kCoarse)), watched(field_of(*scene, kCoarse));
  const Cancellation never;
  watched.stop_when(never);
  const auto samples = std::make_unique<BrickSamples>(),
             same = std::make_unique<BrickSamples>();
  sampler.sample(kDense, *samples);
  watched.sample(kDense, *same);
  EXPECT_EQ(samples->corner[halo_index(3, 4, 5)], same->corner[halo_index(3, 4, 5)]);
  EXPECT_EQ(samples->centre[halo_index(0, 7, 2)], same->centre[halo_index(0, 7, 2)]);
}

TEST(DenseScene, IsNotMadeUpWhereAClockWasSetBack) {
  // A look says that it is cancelled and later ones that it is not: no bricks, and no mesh.
  const auto scene = grains();
  run_with_own_threads(1, [&] {
    CountedLooks never;
    const PhiField field = field_of(*scene, kCoarse);
    ASSERT_TRUE(find_scene_bricks(field, {}, kMaxSurfaceBricks, never.cancellation).ok());
    ASSERT_GT(never.looks, 20U);
    for (std::size_t at = 1; at <= never.looks; ++at) {
      std::size_t looks = 0;
      const Cancellation once(Cancellation::Clock::time_point::max(),
                              [&] { return ++looks == at; });
      EXPECT_FALSE(find_scene_bricks(field, {}, kMaxSurfaceBricks, once).ok()) << at;
    }
  });
}

MeshRequest coarse() {
  MeshRequest request;
  request.spacing = kCoarse;
  request.levels = 0;
  return request;
}

/// A request that evaluates the scene in its own way.
struct Asked {
  const char* how;
  std::size_t looks;  ///< fewer than planning takes, and more than it would without one stage's
  MeshRequest request;
};

std::vector<Asked> all_ways() {
  std::vector<Asked> all{{"plain", 17'000, coarse()},
                         {"graded", 95'000, coarse()},
                         {"labelled", 20'000, coarse()}};
  all[1].request.sizing.grade_surface = true;
  all[1].request.sizing.coarsest = kCoarse;
  all[2].request.labels.emplace();
  all.push_back({"cut, with faces of a node", 32'000, coarse()});
  all[3].request.faces = true;
  all[3].request.face_regions.push_back({.name = "grains", .node = "1"});
  all[3].request.box = WorldBox{{-8, -8, -8}, {8, 8, 8}};
  return all;
}

TEST(DenseScene, StopsBeingPlannedWithinABrick) {
  for (const Asked& asked : all_ways()) {
    SCOPED_TRACE(asked.how);
    const PlanJob job{.shape = grains(), .request = asked.request};
    run_with_own_threads(1, [&] {
      CountedLooks never;
      const auto plan = plan_mesh(job, never.cancellation);
      ASSERT_TRUE(plan.ok()) << plan.status();
      EXPECT_GT(never.looks, asked.looks);
      const std::size_t cuts = test::sanitized_or(2, 4);
      for (std::size_t at = 1; at < never.looks; at += never.looks / cuts) {
        CountedLooks cut{at};
        EXPECT_EQ(plan_mesh(job, cut.cancellation).status().code(),
                  absl::StatusCode::kCancelled);
      }
    });
  }
}

TEST(DenseScene, HasTheSameLabelsAfterSomebodyStoppedSamplingThem) {
  const auto job = make_solid_job({.shape = grains(), .request = all_ways()[2].request});
  ASSERT_TRUE(job.ok()) << job.status();
  const auto sampled = [&](const Cancellation& cancellation) {
    const auto sampler = job->source->sampler();
    sampler->stop_when(cancellation);
    const auto samples = std::make_unique<LabelSamples>();
    if (!sampler->one_label(kDense)) sampler->sample_labels(kDense, *samples);
    return samples->label;
  };
  CountedLooks never;
  const auto whole = sampled(never.cancellation);
  ASSERT_GT(never.looks, 100U);
  for (const std::size_t most : {std::size_t{0}, std::size_t{1}, never.looks / 2}) {
    CountedLooks cut{most};
    EXPECT_NE(sampled(cut.cancellation), whole);
    EXPECT_EQ(sampled({}), whole);
  }
}

/// Fills a chunk, or encodes it, and says in what bytes.
using Fill = std::function<std::vector<std::byte>(const BrickPlan& plan, MeshWorkspace&)>;

std::vector<std::byte> fill_first_chunk(const BrickPlan& plan, MeshWorkspace& workspace) {
  TetMesh chunk(header_of_chunk(plan.header(), plan.chunk(0)));
  plan.fill_chunk(0, workspace, chunk.columns());
  std::vector<std::byte> bytes;
  for (const std::span<std::byte> column : chunk.columns().all()) {
    bytes.insert(bytes.end(), column.begin(), column.end());
  }
  return bytes;
}

std::vector<std::byte> encode_first_chunk(const BrickPlan& plan, MeshWorkspace& workspace) {
  std::vector<std::byte> bytes;
  encode_chunk(plan, 0, workspace, bytes);
  return bytes;
}

/// Filling looks more often than at each brick, and what stopped leaves nothing behind.
void expect_to_stop_within_a_brick(const PlanJob& job,
                                   const Fill& fill,
                                   std::size_t looks_of_brick) {
  const auto planned = plan_mesh(job);
  ASSERT_TRUE(planned.ok()) << planned.status();
  const auto plan = as_bricks(*planned);
  ASSERT_NE(plan, nullptr);
  MeshWorkspace workspace;
  const std::vector<std::byte> whole = fill(*plan, workspace);
  const auto fill_until = [&](CountedLooks& looks) {
    const WatchedFill watched(workspace, looks.cancellation);
    fill(*plan, workspace);
    return looks.looks;
  };
  CountedLooks never;
  const std::size_t looks = fill_until(never);
  const auto [begin, end] = plan->bricks_of_chunk(0);
  EXPECT_GT(looks, looks_of_brick * (end - begin));
  const std::size_t cuts = test::sanitized_or(2, 3);
  for (std::size_t at = 0; at < looks; at += looks / cuts) {
    CountedLooks cut{at};
    EXPECT_EQ(fill_until(cut), at + 1);  // nobody looks again
    EXPECT_EQ(fill(*plan, workspace), whole);
  }
}

TEST(DenseScene, StopsBeingFilledWithinABrickThatIsStuffedAgain) {
  PlanJob job{.shape = grains(), .request = coarse()};
  job.limits.kept_geometry_bytes = 0;
  job.limits.chunk_bytes = std::size_t{1} << 14;
  expect_to_stop_within_a_brick(job, fill_first_chunk, 30);
  expect_to_stop_within_a_brick(job, encode_first_chunk, 30);
}

TEST(DenseScene, StopsBeingFilledWithinABrickWhoseFacesAreOfNodes) {
  PlanJob job{.shape = grains(), .request = all_ways().back().request};
  job.request.box.reset();
  expect_to_stop_within_a_brick(job, fill_first_chunk, 4);
}

}  // namespace
}  // namespace tet
