// Chunks that nobody waits for any more while they are filled.
#include "core/plan/fill_watch.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/own_threads.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/transfer/compact_chunk.h"
#include "core/volume/label_volume.h"
#include "tests/support/counted_looks.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

using test::CountedLooks;

struct NamedPlan {
  std::string name;
  std::shared_ptr<const MeshPlan> plan;
};

std::shared_ptr<const MeshPlan> planned(Shape shape, const MeshRequest& request) {
  auto plan = plan_mesh({.shape = std::move(shape), .request = request});
  EXPECT_TRUE(plan.ok()) << plan.status();
  return *std::move(plan);
}

/// A label for each block of four voxels.
std::shared_ptr<const LabelVolume> blocks() {
  constexpr std::int32_t kEdge = 32;
  std::vector<std::int64_t> labels;
  for (std::int32_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
    const std::int32_t x = i % kEdge / 4, y = i / kEdge % kEdge / 4, z = i / kEdge / kEdge / 4;
    labels.push_back(1 + (7 * x + 5 * y + 3 * z) % 11);
  }
  LabelImage image;
  image.size = {kEdge, kEdge, kEdge};
  image.values = labels;
  return std::make_shared<const LabelVolume>(*make_label_volume(image));
}

GridList two_balls() {
  GridList grids;
  for (const char* name : {"a", "b"}) {
    Volume volume = test::ball(20);
    volume.name = name;
    grids.push_back(std::make_shared<const Volume>(std::move(volume)));
  }
  return grids;
}

/// One of each kind whose chunks are filled brick by brick, whatever lies on top of it.
std::vector<NamedPlan> plans() {
  const auto ball = std::make_shared<const Volume>(test::ball(20));
  MeshRequest plain, uniform, improved, faced, creased, labelled;
  uniform.levels = 0;
  improved.improve = true;
  faced.faces = true;
  creased.faces = true;
  FaceRegion side;
  side.name = "side";
  side.creases = FaceRegion::Creases{.angle_deg = 40};
  creased.face_regions.push_back(side);
  labelled.labels.emplace();
  return {{"graded", planned(ball, plain)},         {"uniform", planned(ball, uniform)},
          {"improved", planned(ball, improved)},    {"with faces", planned(ball, faced)},
          {"creased", planned(ball, creased)},      {"joined", planned(two_balls(), plain)},
          {"labelled", planned(blocks(), labelled)}};
}

constexpr std::byte kUnwritten{0xee};

/// A chunk's columns, which nobody has written.
TetMesh unwritten(const MeshPlan& plan, std::uint64_t index) {
  TetMesh chunk(header_of_chunk(plan.header(), plan.chunk(index)));
  for (const std::span<std::byte> column : chunk.columns().all()) {
    std::ranges::fill(column, kUnwritten);
  }
  return chunk;
}

/// About how much of the tets is written: their numbers have other bytes.
std::size_t written_tets(const TetMesh& chunk) {
  const std::span<const std::byte> tets = chunk.tets.bytes();
  return tets.size() - static_cast<std::size_t>(std::ranges::count(tets, kUnwritten));
}

std::vector<std::byte> bytes_of(TetMesh chunk) {
  std::vector<std::byte> bytes;
  for (const std::span<std::byte> column : chunk.columns().all()) {
    bytes.insert(bytes.end(), column.begin(), column.end());
  }
  return bytes;
}

std::vector<std::byte> filled(const MeshPlan& plan,
                              std::uint64_t index,
                              MeshWorkspace& workspace) {
  TetMesh chunk = unwritten(plan, index);
  plan.fill_chunk(index, workspace, chunk.columns());
  return bytes_of(std::move(chunk));
}

/// Looks that filling a whole chunk takes.
std::size_t looks_at(const MeshPlan& plan, std::uint64_t index) {
  MeshWorkspace workspace;
  CountedLooks whole;
  const WatchedFill watched(workspace, whole.cancellation);
  filled(plan, index, workspace);
  return whole.looks;
}

TEST(FillWatch, LooksAtEachBrickOfAChunk) {
  for (const NamedPlan& one : plans()) {
    if (one.name == "joined" || one.name == "labelled") continue;  // made of others; of no such
    const BrickPlan* const bricks = bricks_beneath(*one.plan);
    if (bricks == nullptr) continue;
    const auto [begin, end] = bricks->bricks_of_chunk(0);
    EXPECT_GE(looks_at(*one.plan, 0), end - begin) << one.name;
  }
}

TEST(FillWatch, StopsAtOnceWhereverItLooks) {
  for (const NamedPlan& one : plans()) {
    SCOPED_TRACE(one.name);
    const std::size_t looks = looks_at(*one.plan, 0);
    ASSERT_GT(looks, 20U);
    MeshWorkspace workspace;
    const std::vector<std::byte> whole = filled(*one.plan, 0, workspace);
    std::size_t before = 0, most = 0;
    for (std::size_t at = 0; at < looks; ++at) {
      TetMesh chunk = unwritten(*one.plan, 0);
      {
        CountedLooks cut{at};
        const WatchedFill watched(workspace, cut.cancellation);
        one.plan->fill_chunk(0, workspace, chunk.columns());
        EXPECT_EQ(cut.looks, at + 1);  // nobody goes on, nor looks again
      }
      const std::size_t written = written_tets(chunk);
      EXPECT_TRUE(at > 0 || written == 0);
      most = std::max(most, written - std::min(before, written));
      before = written;
    }
    // Between two looks lies one brick: a small part of a chunk.
    EXPECT_LT(most, whole.size() / 4);
    // What was not whole leaves nothing behind.
    EXPECT_EQ(filled(*one.plan, 0, workspace), whole);
  }
}

TEST(FillWatch, StopsEncodingACompactChunk) {
  const auto plan = planned(std::make_shared<const Volume>(test::ball(20)), {});
  const BrickPlan& bricks = *as_bricks(*plan);
  const auto [begin, end] = bricks.bricks_of_chunk(0);
  MeshWorkspace workspace;
  std::vector<std::byte> whole, cut;
  CountedLooks never, early{5};
  {
    const WatchedFill watched(workspace, never.cancellation);
    encode_chunk(bricks, 0, workspace, whole);
  }
  EXPECT_EQ(never.looks, end - begin);
  const WatchedFill watched(workspace, early.cancellation);
  encode_chunk(bricks, 0, workspace, cut);
  EXPECT_EQ(early.looks, 6U);
  EXPECT_LT(cut.size(), whole.size());
}

TEST(FillWatch, StopsFillingAMeshWithinARunOfBricks) {
  const auto plan = planned(std::make_shared<const Volume>(test::ball(20)), {});
  std::size_t bricks = 0;
  for (std::uint64_t i = 0; i < plan->header().chunk_count; ++i) {
    const auto [begin, end] = as_bricks(*plan)->bricks_of_chunk(i);
    bricks += end - begin;
  }
  run_with_own_threads(1, [&] {
    CountedLooks never;
    ASSERT_TRUE(fill_mesh(*plan, never.cancellation, nullptr).ok());
    EXPECT_GT(never.looks, bricks);
    for (std::size_t at = 0; at < never.looks; at += 11) {
      CountedLooks cut{at};
      EXPECT_EQ(fill_mesh(*plan, cut.cancellation, nullptr).status().code(),
                absl::StatusCode::kCancelled);
    }
  });
}

}  // namespace
}  // namespace tet
