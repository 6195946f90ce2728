#include "core/transfer/mesh_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/own_threads.h"
#include "tests/core/plan/mesh_patches.h"
#include "tests/support/counted_looks.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::mesh_patch_test {
namespace {

struct Case {
  std::string name;
  Volume earlier, now;
  MeshRequest request;
};

std::vector<Case> cases() {
  MeshRequest graded, uniform, manifold, both_sides, steps;
  uniform.levels = 0;
  manifold.manifold = true;
  both_sides.preset = Preset::kBothSides;
  steps.spacing = 1.3;
  const Volume ball = dented_ball(0), dented = dented_ball(5),
               inner = dented_ball(6, {0, 9, 9});
  std::vector<Case> cases;
  const auto add = [&](const char* name, const Volume& earlier, const Volume& now,
                       const MeshRequest& request) {
    cases.push_back({name, earlier, now, request});
  };
  add("a dent", ball, dented, graded);
  add("a dent, uniform", ball, dented, uniform);
  add("a dent, manifold", ball, dented, manifold);
  add("a dent, both sides", ball, dented, both_sides);
  add("a dent, other steps", ball, dented, steps);
  add("a dent mended", dented, ball, graded);
  add("a hole within", ball, inner, graded);
  add("nothing", ball, ball, graded);
  add("signs", test::random_signs(24, 8), test::random_signs(24, 9), graded);
  return cases;
}

TEST(MeshPatch, MakesTheSameBytesAsTheWholeMesh) {
  for (const Case& c : test::few_of(cases(), 5)) {
    SCOPED_TRACE(c.name);
    const Plan earlier = plan_of(c.earlier, c.request), now = plan_of(c.now, c.request);
    ASSERT_TRUE(earlier && now);
    for (const PatchDetail detail : kDetails) {
      const auto patch = patch_between(earlier, now, detail);
      if (patch == nullptr) {
        EXPECT_FALSE(can_splice(earlier->header(), now->header()));
        continue;
      }
      EXPECT_TRUE(same_bytes(spliced(mesh_of(*earlier), *now, *patch), mesh_of(*now)));
    }
  }
}

TEST(MeshPatch, MakesTheSameBytesWhereverTheChangeIs) {
  std::mt19937 random(7);
  const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 61) - 30; };
  for (int turn = 0; turn < test::sanitized_or(3, 8); ++turn) {
    SCOPED_TRACE(turn);
    MeshRequest request;
    request.preset = turn % 3 == 0 ? Preset::kBothSides : Preset::kDefault;
    if (turn % 2 != 0) request.spacing = 0.9;
    const float depth = static_cast<float>(random() % 12) / 2;
    const VoxelCoord at{coordinate(), coordinate(), coordinate()};
    const Plan earlier = plan_of(dented_ball(0), request);
    const Plan now = plan_of(dented_ball(depth, at), request);
    ASSERT_TRUE(earlier && now);
    for (const PatchDetail detail : kDetails) {
      const auto patch = patch_between(earlier, now, detail);
      ASSERT_TRUE(patch);
      EXPECT_TRUE(same_bytes(spliced(mesh_of(*earlier), *now, *patch), mesh_of(*now)));
    }
  }
}

/// Tets of a mesh by where their corners lie, and on which side they are.
using Shapes = std::vector<std::pair<std::array<std::array<double, 3>, 4>, MeshRegion>>;

/// In order.
Shapes shapes_of(const TetMesh& mesh) {
  Shapes shapes;
  shapes.reserve(mesh.header.tet_count);
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    std::array<std::array<double, 3>, 4> corners;
    std::ranges::transform(mesh.view().stored_places(i), corners.begin(),
                           [](const WorldPoint& at) {
                             return std::array{at.x, at.y, at.z};
                           });
    shapes.emplace_back(corners, mesh.region(i));
  }
  std::ranges::sort(shapes);
  return shapes;
}

/// What a patch by slices brings of a uniform mesh is not much more than what must come;
/// coarser bricks come as a whole.
TEST(MeshPatch, BringsBySlicesWhatHasNotBeenThere) {
  for (const Case& c : test::few_of(cases(), 1)) {  // comparing all shapes takes minutes there
    if (c.name == "signs") continue;
    SCOPED_TRACE(c.name);
    const Plan earlier = plan_of(c.earlier, c.request), now = plan_of(c.now, c.request);
    ASSERT_TRUE(earlier && now);
    const auto by_bricks = patch_between(earlier, now);
    const auto by_slices = patch_between(earlier, now, PatchDetail::kSlices);
    ASSERT_TRUE(by_bricks && by_slices);
    Shapes changed_shapes;
    std::ranges::set_difference(shapes_of(mesh_of(*now)), shapes_of(mesh_of(*earlier)),
                                std::back_inserter(changed_shapes));
    const std::uint64_t changed = changed_shapes.size();
    const std::uint64_t tets = now->header().tet_count;
    const std::uint64_t by_slice = tets - kept_tets(*by_slices);
    const std::uint64_t by_brick = tets - kept_tets(*by_bricks);
    EXPECT_GE(by_slice, changed);
    EXPECT_LE(by_slice, by_brick);
    if (c.request.levels == 0) {
      EXPECT_LE(by_slice - changed, (by_brick - changed) / 2);
    }
  }
}

TEST(MeshPatch, KeepsAllButWhatIsNearTheChange) {
  const Plan earlier = plan_of(dented_ball(0), {}), now = plan_of(dented_ball(5), {});
  const auto patch = patch_between(earlier, now);
  ASSERT_TRUE(patch);
  EXPECT_GT(kept_tets(*patch), now->header().tet_count / 2);
  EXPECT_LT(kept_tets(*patch), now->header().tet_count);
}

TEST(MeshPatch, KeepsEverythingWhereNothingChanged) {
  const Plan plan = plan_of(test::ball(20), {});
  const auto patch = patch_between(plan, plan);
  ASSERT_TRUE(patch);
  EXPECT_EQ(patch->patch_count(), 0U);
  EXPECT_EQ(kept_tets(*patch), plan->header().tet_count);
}

TEST(MeshPatch, IsTheSameWhateverThePlansKept) {
  MeshLimits nothing_kept;
  nothing_kept.kept_geometry_bytes = 0;
  const Volume ball = dented_ball(0), dented = dented_ball(5);
  for (const PatchDetail detail : kDetails) {
    const auto one = patch_between(plan_of(ball, {}), plan_of(dented, {}), detail);
    const auto other = patch_between(plan_of(ball, {}, nothing_kept),
                                     plan_of(dented, {}, nothing_kept), detail);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(one->kept().vertices, other->kept().vertices);
    EXPECT_EQ(one->kept().tets, other->kept().tets);
    EXPECT_EQ(one->patch_count(), other->patch_count());
  }
}

TEST(MeshPatch, KeepsNothingOfAMeshByOtherRules) {
  MeshRequest other;
  other.preset = Preset::kMinAngle;
  const Volume ball = test::ball(12);
  EXPECT_EQ(patch_between(plan_of(ball, {}), plan_of(ball, other)), nullptr);
}

/// Then the lattice has the same places of the world elsewhere.
TEST(MeshPatch, KeepsNothingOfAGridThatWasMovedByWholeCellsOrMirrored) {
  MeshRequest request;
  request.origin = WorldPoint{-64, -64, -64};
  const Volume ball = dented_ball(5, {0, 30, 0});
  Volume moved = ball, mirrored = ball;
  moved.transform.translation = {0, 0, 8};
  mirrored.transform.linear[1][1] = -1;
  const Plan earlier = plan_of(ball, request);
  for (const Volume& volume : {moved, mirrored}) {
    const Plan now = plan_of(volume, request);
    ASSERT_TRUE(earlier && now);
    ASSERT_TRUE(can_splice(earlier->header(), now->header()));
    EXPECT_EQ(patch_between(earlier, now), nullptr);
  }
}

TEST(MeshPatch, KeepsBricksAsAWholeWhereItWouldBeTooManyRuns) {
  const Plan earlier = plan_of(dented_ball(0), {}), now = plan_of(dented_ball(5), {});
  const auto whole = patch_between(earlier, now, PatchDetail::kWhole);
  const auto by_slices = patch_between(earlier, now, PatchDetail::kSlices);
  ASSERT_TRUE(whole && by_slices);
  const auto runs = [](const MeshPatch& patch) {
    return patch.kept().vertices.size() + patch.kept().tets.size();
  };
  ASSERT_LT(runs(*whole), runs(*by_slices));
  const auto with_at_most = [&](std::size_t most) {
    return MeshPatch::between(as_bricks(earlier), as_bricks(now), Cancellation(),
                              PatchDetail::kSlices, {.most_runs = most});
  };
  EXPECT_TRUE(with_at_most(runs(*by_slices))->kept().loose);
  const auto fewer = with_at_most(runs(*whole));
  ASSERT_TRUE(fewer);
  EXPECT_FALSE(fewer->kept().loose);
  EXPECT_EQ(fewer->kept().vertices, whole->kept().vertices);
  EXPECT_EQ(fewer->kept().tets, whole->kept().tets);
  EXPECT_EQ(with_at_most(runs(*whole) - 1), nullptr);
}

TEST(MeshPatch, IsNoneWhereLessIsKeptThanWanted) {
  const Plan earlier = plan_of(dented_ball(0), {}), now = plan_of(dented_ball(5), {});
  const std::uint64_t tets = now->header().tet_count;
  for (const PatchDetail detail : kDetails) {
    const auto patch = patch_between(earlier, now, detail);
    ASSERT_TRUE(patch);
    const std::uint64_t kept = kept_tets(*patch);
    ASSERT_TRUE(kept > 0 && kept < tets);
    const auto with_one_of = [&](std::uint64_t least) {
      return MeshPatch::between(as_bricks(earlier), as_bricks(now), Cancellation(), detail,
                                {.least_kept = least});
    };
    EXPECT_EQ(with_one_of(1), nullptr);
    EXPECT_TRUE(with_one_of(tets / kept + 1));
  }
}

TEST(MeshPatch, IsNoneOnceItIsCancelledWhereverThatIs) {
  const Volume signs = test::random_signs(16, 8), others = test::random_signs(16, 9);
  run_with_own_threads(1, [&] {
    const Plan earlier = plan_of(signs, {}), now = plan_of(others, {});
    ASSERT_TRUE(earlier && now);
    const auto found = [&](test::CountedLooks& looks) {
      return MeshPatch::between(as_bricks(earlier), as_bricks(now), looks.cancellation,
                                PatchDetail::kSlices, {.least_kept = 0});
    };
    test::CountedLooks never;
    const auto patch = found(never);
    ASSERT_TRUE(patch);
    EXPECT_GT(never.looks, 2 * signs.bricks.size());  // for what is kept, and which parts
    for (std::size_t at = 0; at < never.looks; ++at) {
      test::CountedLooks cut{at};
      EXPECT_EQ(found(cut), nullptr) << at << " of " << never.looks;
    }
  });
}

/// A patch of nearly all that there is would take longer than the mesh.
TEST(MeshPatch, IsNoneWhereTheWholeShapeMoved) {
  const auto ball_at = [](float x) {
    return test::narrow_band_volume(
        VoxelBox{VoxelCoord{-30, -30, -30}, VoxelCoord{30, 30, 30}}, 3, [=](VoxelCoord v) {
          return std::hypot(static_cast<float>(v.x) - x, static_cast<float>(v.y),
                            static_cast<float>(v.z)) -
                 20;
        });
  };
  const Plan earlier = plan_of(ball_at(0), {}), now = plan_of(ball_at(0.4F), {});
  EXPECT_TRUE(patch_between(earlier, now, PatchDetail::kSlices));
  EXPECT_EQ(MeshPatch::between(as_bricks(earlier), as_bricks(now), Cancellation(),
                               PatchDetail::kSlices),
            nullptr);
}

}  // namespace
}  // namespace tet::mesh_patch_test
