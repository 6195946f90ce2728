// A mesh that is planned from the plan of another shape is the mesh that is planned alone.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/mesh_difference.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

using Plan = std::shared_ptr<const MeshPlan>;

Plan plan(const Shape& shape, const MeshRequest& request, const MeshPlan* earlier = nullptr) {
  auto made = plan_mesh({.shape = shape, .request = request, .earlier = earlier});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : nullptr;
}

/// What `now` knows that it keeps of `earlier` is what comparing that with `alone` finds.
/// Returns whether it knows.
bool expect_same_kept(const MeshPlan& earlier, const MeshPlan& now, const MeshPlan& alone) {
  const BrickPlan* const before = as_bricks(earlier);
  const BrickPlan* const after = as_bricks(now);
  const BrickPlan* const fresh = as_bricks(alone);
  if (before == nullptr || after == nullptr || fresh == nullptr) return false;
  const CountedMesh& mesh_before = before->counted().mesh;
  EXPECT_EQ(fresh->counted().mesh.kept_of(mesh_before), nullptr);
  const std::vector<KeptBricks>* const known = after->counted().mesh.kept_of(mesh_before);
  if (known == nullptr) return false;
  const std::vector<KeptBricks> found = find_kept_bricks(before->counted(), fresh->counted());
  EXPECT_EQ(known->size(), found.size());
  for (std::size_t level = 0; level < std::min(known->size(), found.size()); ++level) {
    EXPECT_EQ((*known)[level].vertices, found[level].vertices);
    EXPECT_EQ((*known)[level].tets, found[level].tets);
    EXPECT_EQ((*known)[level].nodes, found[level].nodes);
  }
  return true;
}

/// Each is planned from the one before it, and alone. Returns how many knew what they keep.
int expect_same_frames(const std::vector<Shape>& frames, const MeshRequest& request) {
  Plan earlier;
  int knowing = 0;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    SCOPED_TRACE(testing::Message() << "frame " << frame);
    Plan now = plan(frames[frame], request, earlier.get());
    const Plan alone = plan(frames[frame], request);
    EXPECT_TRUE(now && alone);
    if (!now || !alone) return knowing;
    test::expect_same_plans(*now, *alone);
    if (earlier && expect_same_kept(*earlier, *now, *alone)) ++knowing;
    earlier = std::move(now);
  }
  return knowing;
}

/// A ball with a dent that goes around it. The band, its constants and its cubes change.
std::vector<Shape> dented_balls() {
  std::vector<Shape> frames;
  for (const VoxelCoord at : {VoxelCoord{0, 0, 15}, VoxelCoord{0, 11, 11}, VoxelCoord{0, 5, 5},
                              VoxelCoord{0, 5, 5}}) {
    const Volume volume = test::narrow_band_volume(
        VoxelBox{VoxelCoord{-20, -20, -20}, VoxelCoord{20, 20, 20}}, 3, [=](VoxelCoord v) {
          const auto from = [&](VoxelCoord c) {
            return std::hypot(static_cast<float>(v.x - c.x), static_cast<float>(v.y - c.y),
                              static_cast<float>(v.z - c.z));
          };
          return std::max(from({0, 0, 0}) - 15, 4 - from(at));
        });
    frames.emplace_back(std::make_shared<const Volume>(volume));
  }
  return frames;
}

std::vector<Shape> random_grids() {
  std::vector<Shape> frames;
  for (const std::uint32_t seed : {7U, 8U, 9U}) {
    Volume volume = test::random_signs(20, 7);
    const Volume other = test::random_signs(20, seed);
    // Every seventh brick is another's.
    for (std::size_t brick = 0; brick < volume.bricks.size(); brick += 7) {
      const auto at = static_cast<std::ptrdiff_t>(brick * kBrickCells);
      std::copy_n(other.values.begin() + at, kBrickCells, volume.values.begin() + at);
      volume.ranges[brick] = other.ranges[brick];
    }
    frames.emplace_back(std::make_shared<const Volume>(std::move(volume)));
  }
  return frames;
}

/// Two links of a chain, of which one moves.
std::vector<Shape> moving_links() {
  std::vector<Shape> frames;
  for (const double x : {0.0, 0.02, 0.3}) {
    test::SceneWriter writer;
    const std::string torus = writer.add(scene::Torus{1, 0.25});
    const std::string moved = writer.add_moved({1.6 + x, 0.1, 0.3}, torus);
    writer.add(scene::Combination{scene::Combine::kUnion, {torus, moved}, 0.1});
    frames.emplace_back(std::make_shared<const Scene>(writer.scene()));
  }
  return frames;
}

TEST(EarlierPlan, MakesTheMeshThatIsMadeWithoutIt) {
  MeshRequest uniform = test::with_levels(0), finer, coarser, other_iso, both, manifold;
  finer.spacing = 0.7;
  coarser.spacing = 2.3;
  other_iso.iso = 0.4;
  both.preset = Preset::kBothSides;
  manifold.manifold = true;
  for (const MeshRequest& request :
       {MeshRequest{}, uniform, finer, coarser, other_iso, both, manifold}) {
    const bool alone = request.preset == Preset::kBothSides || request.manifold;
    EXPECT_EQ(expect_same_frames(dented_balls(), request), alone ? 0 : 3);
  }
}

TEST(EarlierPlan, MakesTheMeshThatIsMadeWithoutItOfRandomSigns) {
  MeshRequest coarser;
  coarser.spacing = 1.5;
  for (const MeshRequest& request : {MeshRequest{}, coarser}) {
    EXPECT_EQ(expect_same_frames(random_grids(), request), 2);
  }
}

TEST(EarlierPlan, MakesTheMeshThatIsMadeWithoutItOfScenes) {
  MeshRequest request;
  request.spacing = 0.08;
  EXPECT_EQ(expect_same_frames(moving_links(), request), 2);
}

TEST(EarlierPlan, IsNoHelpToAnotherKindOfShapeOrRequest) {
  const std::vector<Shape> grids = dented_balls(), scenes = moving_links();
  MeshRequest request, spaced;
  request.spacing = 0.45;
  spaced.spacing = 0.8;
  const Plan grid = plan(grids[0], request), scene = plan(scenes[0], request);
  test::expect_same_plans(*plan(grids[1], request, scene.get()), *plan(grids[1], request));
  test::expect_same_plans(*plan(scenes[1], request, grid.get()), *plan(scenes[1], request));
  test::expect_same_plans(*plan(grids[1], spaced, grid.get()), *plan(grids[1], spaced));
}

}  // namespace
}  // namespace tet
