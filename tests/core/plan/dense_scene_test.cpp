// Scenes of which one brick is a second's work: they stop within it.
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/own_threads.h"
#include "core/field/find_scene_bricks.h"
#include "core/field/phi_field.h"
#include "core/plan/make/plan_mesh.h"
#include "core/scene/scene_evaluator.h"
#include "tests/support/counted_looks.h"
#include "tests/support/scenes.h"

namespace tet {
namespace {

using test::CountedLooks;

/// Thousands of solids within a brick or two, all of which are evaluated for each.
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
  EXPECT_FALSE(sampler.stopped());
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
    EXPECT_TRUE(sampler.stopped());
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

TEST(DenseScene, StopsBeingPlannedWithinABrick) {
  MeshRequest request;
  request.spacing = kCoarse;
  request.levels = 0;
  const PlanJob job{.shape = grains(), .request = request};
  run_with_own_threads(1, [&] {
    CountedLooks never;
    const auto plan = plan_mesh(job, never.cancellation);
    ASSERT_TRUE(plan.ok()) << plan.status();
    EXPECT_GT(never.looks, 2000U);  // of some bricks
    for (std::size_t at = 1; at < never.looks; at += never.looks / 13) {
      CountedLooks cut{at};
      EXPECT_EQ(plan_mesh(job, cut.cancellation).status().code(), absl::StatusCode::kCancelled);
    }
  });
}

}  // namespace
}  // namespace tet
