// Patches of meshes in tests: of a ball that gets a dent, and what is spliced from them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "core/mesh/stable/row_queue.h"
#include "core/transfer/mesh_patch.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/volume_fixtures.h"

namespace tet::mesh_patch_test {

using test::same_bytes;
using Plan = std::shared_ptr<const MeshPlan>;

inline Plan plan_of(const Volume& volume,
                    const MeshRequest& request,
                    const MeshLimits& limits = {}) {
  const auto plan = plan_mesh(
      {.shape = std::make_shared<const Volume>(volume), .request = request, .limits = limits});
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.ok() ? *plan : nullptr;
}

/// However little is kept.
inline std::shared_ptr<const MeshPatch> patch_between(
    const Plan& earlier, const Plan& now, PatchDetail detail = PatchDetail::kBricks) {
  return MeshPatch::between(as_bricks(earlier), as_bricks(now), Cancellation(), detail,
                            {.least_kept = 0});
}

inline TetMesh mesh_of(const MeshPlan& plan) {
  return std::move(fill_mesh(plan, Cancellation(), nullptr)->mesh);
}

/// The mesh of `now` from that of `earlier` and the patches.
inline TetMesh spliced(const TetMesh& earlier,
                       const MeshPlan& now,
                       const MeshPatch& patch,
                       TetMesh used = {}) {
  absl::StatusOr<TetMesh> mesh =
      splice_mesh(earlier, now.header(), patch.kept(), std::move(used));
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  if (!mesh.ok()) return {};
  MeshWorkspace workspace;
  RowQueue vertices = RowQueue::beside(patch.kept().vertices, now.header().vertex_count);
  RowQueue tets = RowQueue::beside(patch.kept().tets, now.header().tet_count);
  for (std::uint64_t i = 0; i < patch.patch_count(); ++i) {
    const ChunkExtent extent = patch.extent(i);
    if (!patch.kept().loose) {
      patch.fill(i, workspace, mesh->columns_of(extent));
      continue;
    }
    TetMesh chunk(header_of_chunk(now.header(), extent));
    patch.fill(i, workspace, chunk.columns());
    const auto copy = [&](std::uint64_t row, std::uint64_t at, std::uint64_t count) {
      const ChunkColumns from = chunk.columns_of({.first_tet = at, .tet_count = count});
      const ChunkColumns to = mesh->columns_of({.first_tet = row, .tet_count = count});
      std::ranges::copy(from.tets, to.tets.begin());
      std::ranges::copy(from.regions, to.regions.begin());
    };
    EXPECT_TRUE(tets.take(extent.tet_count, copy));
    const auto copy_points = [&](std::uint64_t row, std::uint64_t at, std::uint64_t count) {
      const auto from = chunk.columns_of({.first_vertex = at, .vertex_count = count}).positions;
      const auto to = mesh->columns_of({.first_vertex = row, .vertex_count = count}).positions;
      std::ranges::copy(from, to.begin());
    };
    EXPECT_TRUE(vertices.take(extent.vertex_count, copy_points));
  }
  const auto nothing = [](std::uint64_t, std::uint64_t, std::uint64_t) {};
  if (patch.kept().loose) {
    EXPECT_FALSE(vertices.take(1, nothing) || tets.take(1, nothing));
  }
  return *std::move(mesh);
}

inline constexpr std::array kDetails{PatchDetail::kWhole, PatchDetail::kBricks,
                                     PatchDetail::kSlices};

inline std::uint64_t kept_tets(const MeshPatch& patch) {
  std::uint64_t count = 0;
  for (const KeptRun& run : patch.kept().tets) count += run.count;
  return count;
}

/// A ball of 30 voxels with a dent or a bump of a few voxels at one place.
inline Volume dented_ball(float depth, VoxelCoord at = {0, 0, 30}) {
  return test::narrow_band_volume(
      VoxelBox{VoxelCoord{-40, -40, -40}, VoxelCoord{40, 40, 40}}, 3, [=](VoxelCoord v) {
        const auto from = [&](VoxelCoord c) {
          return std::sqrt(static_cast<float>((v.x - c.x) * (v.x - c.x) +
                                              (v.y - c.y) * (v.y - c.y) +
                                              (v.z - c.z) * (v.z - c.z)));
        };
        const float ball = from({0, 0, 0}) - 30;
        return depth == 0 ? ball : std::max(ball, depth - from(at));
      });
}

}  // namespace tet::mesh_patch_test
