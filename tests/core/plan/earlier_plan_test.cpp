// A mesh that is planned from the plan of another shape is the mesh that is planned alone.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/mesh_difference.h"
#include "core/stuffing/brick_geometry.h"
#include "core/volume/replace_leaves.h"
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
  const Cancellation never;
  const std::vector<KeptBricks> found =
      find_kept_bricks({before->counted(), fresh->counted(), PatchDetail::kBricks, never}, {});
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

/// A grid's leaves as they become, and the bricks that a session names for them.
struct Replacement {
  std::vector<std::pair<BrickCoord, std::vector<float>>> leaves;

  std::vector<BrickCoord> bricks() const {
    std::vector<BrickCoord> bricks;
    for (const auto& [brick, values] : leaves) bricks.push_back(brick);
    return bricks;
  }
  Volume made_of(const Volume& volume) const {
    std::vector<LeafValues> values;
    for (const auto& [brick, of_brick] : leaves) values.push_back({brick, of_brick});
    auto made = replace_leaves(volume, values);
    EXPECT_TRUE(made.ok()) << made.status();
    return made.ok() ? *std::move(made) : volume;
  }
};

std::vector<float> values_of(const Volume& volume, std::size_t leaf) {
  const auto values = std::span(volume.values).subspan(leaf * kBrickCells, kBrickCells);
  return {values.begin(), values.end()};
}

/// Leaves as they were; inflated; gone to the background; new, beyond all others; a cavity in
/// the middle, which was a constant; and one of some hundred, again and again.
std::vector<Replacement> replacements_of(const Volume& volume) {
  std::vector<Replacement> frames;
  const auto leaf = [&](std::size_t i) { return volume.bricks[i % volume.bricks.size()]; };
  frames.push_back({{{leaf(3), values_of(volume, 3)}, {leaf(9), values_of(volume, 9)}}});
  std::vector<float> inflated = values_of(volume, 5);
  for (float& value : inflated) value -= 0.4F;
  frames.push_back({{{leaf(5), inflated}, {leaf(0), values_of(volume, 0)}}});
  const std::size_t last = volume.bricks.size() - 1;
  frames.push_back({{{leaf(last), {volume.background}}, {leaf(0), {volume.background}}}});
  std::vector<float> speck(kBrickCells, 2.0F);
  for (const std::size_t voxel : {292U, 293U, 300U, 301U, 356U, 357U, 364U, 365U}) {
    speck[voxel] = -1;
  }
  const BrickCoord beyond{leaf(last).x + 3, leaf(last).y, leaf(last).z};
  frames.push_back({{{beyond, speck}}});
  std::vector<float> cavity = speck;
  for (float& value : cavity) value = -value;
  frames.push_back({{{{0, 0, 0}, cavity}, {beyond, {volume.background}}}});
  for (std::size_t i = 0; i < 40; ++i) {
    std::vector<float> moved = values_of(volume, i * 7 % volume.bricks.size());
    for (float& value : moved) value += 0.01F * static_cast<float>(i % 5);
    frames.push_back({{{leaf(i * 7), moved}}});
  }
  return frames;
}

const Survey& survey_of(const MeshPlan& plan) {
  return as_bricks(plan)->counted().mesh.survey();
}

const KeptGeometry& geometry_of(const MeshPlan& plan) { return survey_of(plan).geometry; }

/// Whether all geometry is at hand that there is.
bool has_all_geometry(const Survey& survey) {
  for (std::size_t i = 0; i < survey.bricks.size(); ++i) {
    const bool is_kept = survey.geometry.of_brick[i] != nullptr;
    if (!is_kept && GeometrySizes(survey.stuffed[i]).bytes() > 0) return false;
  }
  return true;
}

TEST(EarlierPlan, MakesTheMeshThatIsMadeWithoutItWhereLeavesAreNamed) {
  MeshRequest finer;
  finer.spacing = 0.8;
  for (const MeshRequest& request : {MeshRequest{}, finer}) {
    auto volume = std::make_shared<const Volume>(test::ball(17));
    Plan earlier = plan(volume, request);
    for (const Replacement& replacement : replacements_of(*volume)) {
      volume = std::make_shared<const Volume>(replacement.made_of(*volume));
      std::vector<BrickCoord> replaced = replacement.bricks();
      replaced.push_back({1, 1, 1});  // named, and as it was
      auto now = plan_mesh({.shape = volume,
                            .request = request,
                            .earlier = earlier.get(),
                            .replaced = &replaced});
      ASSERT_TRUE(now.ok()) << now.status();
      const Plan alone = plan(volume, request);
      test::expect_same_plans(**now, *alone);
      EXPECT_TRUE(expect_same_kept(*earlier, **now, *alone));
      earlier = *std::move(now);
    }
  }
}

TEST(EarlierPlan, SharesGeometryAndHoldsLittleThatIsGone) {
  const auto first = std::make_shared<const Volume>(test::ball(17));
  auto volume = first;
  Plan earlier = plan(volume, {});
  const std::uint64_t bytes_alone = geometry_of(*earlier).block_bytes;
  int sharing = 0, packing_anew = 0;
  for (std::size_t frame = 0; frame < 100; ++frame) {
    // Whatever a leaf was, it is the first one's, more or less inflated.
    const std::size_t leaf = frame * 7 % first->bricks.size();
    std::vector<float> values = values_of(*first, leaf);
    for (float& value : values) value += 0.01F * static_cast<float>(frame % 5);
    volume = std::make_shared<const Volume>(
        Replacement{{{first->bricks[leaf], values}}}.made_of(*volume));
    Plan now = plan(volume, {}, earlier.get());
    const KeptGeometry& before = geometry_of(*earlier);
    const KeptGeometry& after = geometry_of(*now);
    const bool shares = !after.blocks.empty() && after.blocks[0] == before.blocks[0];
    (shares ? sharing : packing_anew) += 1;
    EXPECT_TRUE(shares || after.gone == 0) << frame;
    EXPECT_LE(after.block_bytes, 3 * bytes_alone) << frame;
    EXPECT_TRUE(has_all_geometry(survey_of(*now))) << frame;
    earlier = std::move(now);
  }
  EXPECT_GT(sharing, 10);
  EXPECT_GT(packing_anew, 3);
  test::expect_same_plans(*earlier, *plan(volume, {}));
}

TEST(EarlierPlan, SharesNoGeometryWhereWhatIsNewWouldHaveNoRoom) {
  const auto volume = std::make_shared<const Volume>(test::ball(17));
  const Plan earlier = plan(volume, {});
  const std::uint64_t bytes = geometry_of(*earlier).block_bytes;
  for (const std::uint64_t room : {std::uint64_t{0}, bytes / 3, 2 * bytes - 1, 2 * bytes}) {
    MeshLimits limits;
    limits.kept_geometry_bytes = room;
    const auto now = plan_mesh({.shape = volume, .limits = limits, .earlier = earlier.get()});
    ASSERT_TRUE(now.ok()) << now.status();
    const KeptGeometry& kept = geometry_of(**now);
    EXPECT_LE(kept.block_bytes, room);
    const bool shares =
        !kept.blocks.empty() && kept.blocks[0] == geometry_of(*earlier).blocks[0];
    EXPECT_EQ(shares, room == 2 * bytes);
    test::expect_same_plans(**now, *earlier);
  }
}

}  // namespace
}  // namespace tet
