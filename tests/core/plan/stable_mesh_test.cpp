#include "core/mesh/stable/stable_mesh.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/transfer/mesh_patch.h"
#include "tests/core/plan/mesh_patches.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::stable_mesh_test {
namespace {

using mesh_patch_test::patch_between;
using test::same_bytes;
using Plan = std::shared_ptr<const MeshPlan>;

/// About one origin, or nothing could be kept.
Plan plan_of(Volume volume, MeshRequest request) {
  request.origin = WorldPoint{0, 0, 0};
  const auto plan = plan_mesh(
      {.shape = std::make_shared<const Volume>(std::move(volume)), .request = request});
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.ok() ? *plan : nullptr;
}

/// A ball of 24 voxels without what lies near some place; always in the same box, so that all
/// have one origin.
Volume dented_ball(float depth, VoxelCoord at, float radius = 24) {
  return test::narrow_band_volume(
      VoxelBox{VoxelCoord{-32, -32, -32}, VoxelCoord{32, 32, 32}}, 3, [=](VoxelCoord v) {
        const auto from = [&](VoxelCoord c) {
          return std::hypot(static_cast<float>(v.x - c.x), static_cast<float>(v.y - c.y),
                            static_cast<float>(v.z - c.z));
        };
        return std::max(from({0, 0, 0}) - radius, depth - from(at));
      });
}

/// `mesh` becomes that of `now` from that of `earlier`, as a session does it: by what is kept.
void follow(StableMesh& mesh,
            const Plan& earlier,
            const Plan& now,
            PatchDetail detail = PatchDetail::kSlices) {
  const auto patch = patch_between(earlier, now, detail);
  const absl::Status begun =
      mesh.begin(now->header(), patch == nullptr ? nullptr : &patch->kept());
  ASSERT_TRUE(begun.ok()) << begun;
  MeshWorkspace workspace;
  const std::uint64_t chunks = patch ? patch->patch_count() : now->header().chunk_count;
  for (std::uint64_t i = 0; i < chunks; ++i) {
    const ChunkExtent extent = patch ? patch->extent(i) : now->chunk(i);
    const ChunkColumns columns = mesh.place(extent);
    if (patch) {
      patch->fill(i, workspace, columns);
    } else {
      now->fill_chunk(i, workspace, columns);
    }
    ASSERT_TRUE(mesh.take(extent).ok());
  }
}

std::uint64_t slot_of(const SlotLayout& layout, std::uint64_t number) {
  std::uint64_t found = 0;
  layout.for_each_run(number, 1,
                      [&](std::uint64_t slot, std::uint64_t, std::uint64_t) { found = slot; });
  return found;
}

void expect_kept_in_place(const SlotLayout& before,
                          const SlotLayout& now,
                          std::span<const KeptRun> kept) {
  for (const KeptRun& run : kept) {
    for (std::uint64_t i = 0; i < run.count; ++i) {
      ASSERT_EQ(slot_of(before, run.from + i), slot_of(now, run.to + i));
    }
  }
}

/// Holes, and only they, are tets without corners; no other tet has a hole for a corner.
void expect_harmless_holes(const StableMesh& mesh) {
  const auto holes_of = [](const SlotLayout& layout) {
    std::vector<bool> is_hole(layout.slots(), true);
    for (const SlotRun& run : layout.runs()) {
      for (std::uint64_t i = 0; i < run.count; ++i) is_hole[run.slot + i] = false;
    }
    return is_hole;
  };
  const std::vector<bool> vertices = holes_of(mesh.vertices()), tets = holes_of(mesh.tets());
  for (std::uint64_t i = 0; i < tets.size(); ++i) {
    for (const std::uint64_t corner : mesh.slots().tet(i)) {
      if (tets[i]) {
        ASSERT_EQ(corner, 0U);
      } else {
        ASSERT_FALSE(vertices[corner]);
      }
    }
  }
}

std::vector<Plan> random_frames(std::uint32_t seed, const MeshRequest& request, int count) {
  std::mt19937 random(seed);
  const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 49) - 24; };
  std::vector<Plan> frames;
  for (int i = 0; i < count; ++i) {
    const auto depth = static_cast<float>(random() % 20) / 2;
    frames.push_back(
        plan_of(dented_ball(depth, {coordinate(), coordinate(), coordinate()}), request));
  }
  return frames;
}

TEST(StableMesh, IsTheWholeMeshInOrderAndKeepsIdsOfWhatIsKept) {
  MeshRequest uniform, both_sides, wide;
  uniform.levels = 0;
  both_sides.preset = Preset::kBothSides;
  wide.coordinates = CoordinateType::kFloat64;
  const int frames = test::sanitized_or(3, 6);
  std::uint32_t seed = 28;
  const std::vector<MeshRequest> requests{{}, uniform, both_sides, wide};
  for (const MeshRequest& request : test::few_of(requests, 3)) {
    SCOPED_TRACE(++seed);
    // A server may bring either, and from one frame to the next the other.
    const auto detail = seed % 2 == 0 ? PatchDetail::kBricks : PatchDetail::kSlices;
    StableMesh mesh;
    Plan earlier;
    for (const Plan& now : random_frames(seed, request, frames)) {
      ASSERT_TRUE(now);
      const SlotLayout vertices = mesh.vertices(), tets = mesh.tets();
      follow(mesh, earlier, now, detail);
      const auto whole = mesh.in_order();
      ASSERT_TRUE(whole.ok()) << whole.status();
      EXPECT_TRUE(same_bytes(*whole, fill_mesh(*now, Cancellation(), nullptr)->mesh));
      expect_harmless_holes(mesh);
      if (!mesh.renumbered()) {
        const auto patch = patch_between(earlier, now, detail);
        expect_kept_in_place(vertices, mesh.vertices(), patch->kept().vertices);
        expect_kept_in_place(tets, mesh.tets(), patch->kept().tets);
      }
      earlier = now;
    }
  }
}

TEST(StableMesh, HasTheSameBytesForTheSameFrames) {
  StableMesh one, other;
  Plan earlier;
  for (const Plan& now : random_frames(5, {}, 5)) {
    TaskPool(1).run([&] { follow(one, earlier, now); });
    TaskPool(4).run([&] { follow(other, earlier, now); });
    EXPECT_TRUE(same_bytes(one.slots(), other.slots()));
    EXPECT_EQ(one.tets().runs(), other.tets().runs());
    earlier = now;
  }
}

TEST(StableMesh, IsPutInOrderWhereHolesWouldBeMany) {
  const Plan large = plan_of(dented_ball(0, {0, 0, 40}), {});
  const Plan half = plan_of(dented_ball(34, {0, 0, 24}), {});
  const Plan dent = plan_of(dented_ball(35, {0, 0, 24}), {});
  StableMesh mesh;
  follow(mesh, nullptr, large);
  EXPECT_TRUE(mesh.renumbered());
  follow(mesh, large, half);
  EXPECT_GT(mesh.tets().holes(), 0U);
  follow(mesh, half, dent);
  EXPECT_TRUE(mesh.renumbered());
  EXPECT_LE(mesh.tets().holes() * 8, mesh.tets().slots());
  EXPECT_TRUE(same_bytes(*mesh.in_order(), fill_mesh(*dent, Cancellation(), nullptr)->mesh));
}

TEST(StableMesh, RefusesRunsThatDoNotFitAndStaysAsItWas) {
  const Plan ball = plan_of(dented_ball(0, {0, 0, 40}), {});
  StableMesh mesh;
  follow(mesh, nullptr, ball);
  const MeshHeader& header = ball->header();
  constexpr std::uint64_t kFar = ~std::uint64_t{0};
  for (const KeptRun& run : {KeptRun{0, 0, header.vertex_count + 1}, KeptRun{kFar, 0, 2},
                             KeptRun{0, kFar, 2}, KeptRun{5, 0, header.vertex_count}}) {
    const KeptParts vertices{{run}, {}}, tets{{}, {{run.from, run.to, header.tet_count + 1}}};
    EXPECT_TRUE(absl::IsInvalidArgument(mesh.begin(header, &vertices)));
    EXPECT_TRUE(absl::IsInvalidArgument(mesh.begin(header, &tets)));
  }
  const KeptParts twice{{{0, 0, 10}, {5, 20, 10}}, {}};
  EXPECT_TRUE(absl::IsInvalidArgument(mesh.begin(header, &twice)));
  EXPECT_TRUE(same_bytes(*mesh.in_order(), fill_mesh(*ball, Cancellation(), nullptr)->mesh));
}

/// What a server could say: tets are kept, and their vertices are not.
TEST(StableMesh, FindsAKeptTetWhoseVertexIsNotKept) {
  const Plan ball = plan_of(dented_ball(0, {0, 0, 40}), {});
  StableMesh mesh;
  follow(mesh, nullptr, ball);
  MeshHeader header = ball->header();
  header.vertex_count = 10;
  const KeptParts kept{{}, {{0, 0, header.tet_count}}};
  ASSERT_TRUE(mesh.begin(header, &kept).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(mesh.in_order().status()));
}

constexpr std::uint64_t kNoSlot = ~std::uint64_t{0};

/// Runs of some of `count` numbers, in their order, at numbers of the next mesh.
std::vector<KeptRun> some_runs(std::mt19937& random, std::uint64_t count) {
  std::vector<KeptRun> runs;
  std::uint64_t from = random() % 4, to = random() % 4;
  while (from < count) {
    const std::uint64_t kept = std::min<std::uint64_t>(1 + random() % 6, count - from);
    runs.push_back({from, to, kept});
    from += kept + random() % 4;
    to += kept + random() % 4;
  }
  return runs;
}

/// The slots of the next mesh's `count` numbers, found one by one; `total` of them there are.
std::vector<std::uint64_t> slots_after(const std::vector<std::uint64_t>& slots,
                                       const std::vector<KeptRun>& kept,
                                       std::uint64_t count,
                                       std::uint64_t& total) {
  std::vector<std::uint64_t> now(count, kNoSlot);
  std::vector<bool> taken(total);
  for (const KeptRun& run : kept) {
    for (std::uint64_t i = 0; i < run.count; ++i) {
      taken[now[run.to + i] = slots[run.from + i]] = true;
    }
  }
  std::uint64_t next = 0;
  for (std::uint64_t& slot : now) {
    if (slot != kNoSlot) continue;
    while (next < total && taken[next]) ++next;
    if (next == total) taken.push_back(true), ++total;
    slot = next++;
  }
  return now;
}

/// Slots of the earlier mesh or of the next one, without those that were kept.
std::set<std::uint64_t> changed_slots(const std::vector<std::uint64_t>& before,
                                      const std::vector<KeptRun>& kept,
                                      const std::vector<std::uint64_t>& now) {
  std::set<std::uint64_t> changed(before.begin(), before.end());
  changed.insert(now.begin(), now.end());
  for (const KeptRun& run : kept) {
    for (std::uint64_t i = 0; i < run.count; ++i) changed.erase(before[run.from + i]);
  }
  return changed;
}

void expect_slots(const std::vector<SlotRange>& ranges,
                  const std::set<std::uint64_t>& expected) {
  std::set<std::uint64_t> slots;
  std::uint64_t end = 0;
  for (const SlotRange& range : ranges) {
    ASSERT_GT(range.count, 0U);
    ASSERT_TRUE(slots.empty() || range.begin > end);
    for (std::uint64_t i = 0; i < range.count; ++i) slots.insert(range.begin + i);
    end = range.begin + range.count;
  }
  EXPECT_EQ(slots, expected);
}

TEST(SlotLayout, FollowsAsOneNumberAfterTheOtherWould) {
  std::mt19937 random(11);
  for (int turn = 0; turn < test::sanitized_or(50, 200); ++turn) {
    SlotLayout layout(random() % 40);
    std::vector<std::uint64_t> slots(layout.count());
    for (std::uint64_t i = 0; i < slots.size(); ++i) slots[i] = i;
    std::uint64_t total = slots.size();
    for (int frame = 0; frame < 6; ++frame) {
      const std::vector<KeptRun> kept = some_runs(random, slots.size());
      const std::uint64_t end = kept.empty() ? 0 : kept.back().to + kept.back().count;
      const std::uint64_t count = end + random() % 9;
      const std::vector<std::uint64_t> before = slots;
      slots = slots_after(slots, kept, count, total);
      expect_slots(layout.follow(kept, count).changed, changed_slots(before, kept, slots));
      ASSERT_EQ(layout.count(), count);
      ASSERT_EQ(layout.slots(), total);
      for (std::uint64_t i = 0; i < count; ++i) ASSERT_EQ(slot_of(layout, i), slots[i]);
      std::uint64_t free = 0;
      for (const SlotRange& range : layout.free()) free += range.count;
      ASSERT_EQ(free, layout.holes());
    }
  }
}

}  // namespace
}  // namespace tet::stable_mesh_test
