// A mesh of a grid of which one leaf in a hundred changed, from the mesh before: counting,
// finding what is kept, making the rest and splicing it in, or patching the mesh in place,
// beside making the whole mesh.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/mesh/stable/row_queue.h"
#include "core/mesh/stable/splice.h"
#include "core/mesh/stable/stable_mesh.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"
#include "core/transfer/mesh_patch.h"

namespace tet::bench {
namespace {

using Plan = std::shared_ptr<const MeshPlan>;

/// Time of the processor that all threads have taken, in seconds: whatever else the machine
/// does counts for less than in real time.
double now() noexcept {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The hundredth of a volume's leaves that lies nearest to one of them, by their places.
std::vector<std::size_t> leaves_at_one_place(const Volume& volume) {
  const BrickCoord centre = volume.bricks[volume.bricks.size() / 3];
  const auto distance = [&](std::size_t i) {
    const BrickCoord b = volume.bricks[i];
    return std::hypot(b.x - centre.x, b.y - centre.y, b.z - centre.z);
  };
  std::vector<std::size_t> order(volume.bricks.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, distance);
  order.resize(order.size() / 100 + 1);
  return order;
}

/// The volume with these leaves a little inflated.
Volume inflated(const Volume& volume, const std::vector<std::size_t>& leaves) {
  Volume changed = volume;
  for (const std::size_t brick : leaves) {
    for (std::size_t v = brick * kBrickCells; v < (brick + 1) * kBrickCells; ++v) {
      changed.values[v] = std::max(changed.values[v] - 0.2F, -changed.background);
    }
    const auto values = std::span(changed.values).subspan(brick * kBrickCells, kBrickCells);
    const auto [min, max] = std::ranges::minmax(values);
    changed.ranges[brick] = {min, max};
  }
  return changed;
}

Plan plan(const std::shared_ptr<const Volume>& volume,
          const MeshPlan* earlier = nullptr,
          const std::vector<BrickCoord>* replaced = nullptr) {
  return plan_mesh({.shape = volume, .earlier = earlier, .replaced = replaced}).value();
}

/// Seconds of updates, by part; of splicing both ways.
struct Parts {
  double plan = 0, compare = 0, fill = 0, splice = 0, in_place = 0, whole = 0;
  double sent_tets = 0, sent_bytes = 0, runs = 0, renumbered = 0;
};

/// A mesh as sessions keep it: spliced in the memory of the one before it, and patched in
/// place.
struct Meshes {
  std::vector<BrickCoord> replaced;  ///< leaves of each frame, as a session is told
  Plan plan;
  TetMesh mesh, used;
  StableMesh stable;
  std::vector<TetMesh> made;  ///< patches
  ScratchPool<MeshWorkspace> workspaces;
};

/// As a server does, with memory that was used before.
void fill_patches(const MeshPatch& patch, const MeshHeader& header, Meshes& meshes) {
  if (meshes.made.size() < patch.patch_count()) meshes.made.resize(patch.patch_count());
  for_each_range(patch.patch_count(), 1, [&](std::size_t begin, std::size_t end) {
    const ScratchPool<MeshWorkspace>::Turn workspace(meshes.workspaces);
    for (std::size_t i = begin; i < end; ++i) {
      TetMesh& made = meshes.made[i];
      made = TetMesh(header_of_chunk(header, patch.extent(i)), std::move(made));
      patch.fill(i, *workspace, made.columns());
    }
  });
}

/// Puts patches between the parts that are kept, as a client does that has received them.
void place_patches(const MeshPatch& patch, const std::vector<TetMesh>& made, TetMesh& mesh) {
  RowQueue vertices = RowQueue::beside(patch.kept().vertices, mesh.header.vertex_count);
  RowQueue tets = RowQueue::beside(patch.kept().tets, mesh.header.tet_count);
  const auto copy = [](const ByteBuffer& from, ByteBuffer& to, std::size_t row_bytes) {
    return [&from, &to, row_bytes](std::uint64_t row, std::uint64_t at, std::uint64_t count) {
      std::ranges::copy(from.bytes().subspan(at * row_bytes, count * row_bytes),
                        to.bytes().begin() + static_cast<std::ptrdiff_t>(row * row_bytes));
    };
  };
  for (std::uint64_t i = 0; i < patch.patch_count(); ++i) {
    const ChunkExtent extent = patch.extent(i);
    const std::size_t row = 3 * size_of(mesh.header.coordinate_type);
    if (!vertices.take(extent.vertex_count, copy(made[i].positions, mesh.positions, row)) ||
        !tets.take(extent.tet_count,
                   copy(made[i].tets, mesh.tets, 4 * size_of(mesh.header.index_type)))) {
      std::abort();
    }
  }
}

/// Does the same where ids do not move.
void patch_in_place(const MeshPatch& patch,
                    const MeshHeader& header,
                    const std::vector<TetMesh>& made,
                    StableMesh& stable) {
  if (!stable.begin(header, &patch.kept()).ok()) std::abort();
  for (std::uint64_t i = 0; i < patch.patch_count(); ++i) {
    const ChunkExtent extent = patch.extent(i);
    const auto from = const_cast<TetMesh&>(made[i]).columns().all();
    const auto to = stable.place(extent).all();
    for (std::size_t column = 0; column < from.size(); ++column) {
      std::ranges::copy(from[column], to[column].begin());
    }
    if (!stable.take(extent).ok()) std::abort();
  }
}

/// Updates as a session does, both with stable ids and without.
void update_once(Meshes& meshes, const std::shared_ptr<const Volume>& volume, Parts& parts) {
  double start = now();
  Plan next = plan(volume, meshes.plan.get(), &meshes.replaced);
  parts.plan += now() - start;
  start = now();
  const auto patch = MeshPatch::between(as_bricks(meshes.plan), as_bricks(next), Cancellation(),
                                        PatchDetail::kSlices);
  parts.compare += now() - start;
  start = now();
  fill_patches(*patch, next->header(), meshes);
  parts.fill += now() - start;
  start = now();
  TetMesh updated =
      splice_mesh(meshes.mesh, next->header(), patch->kept(), std::move(meshes.used)).value();
  place_patches(*patch, meshes.made, updated);
  parts.splice += now() - start;
  start = now();
  patch_in_place(*patch, next->header(), meshes.made, meshes.stable);
  parts.in_place += now() - start;
  parts.renumbered += meshes.stable.renumbered() ? 1 : 0;
  for (std::uint64_t i = 0; i < patch->patch_count(); ++i) {
    const ChunkExtent extent = patch->extent(i);
    parts.sent_tets += static_cast<double>(extent.tet_count);
    parts.sent_bytes += static_cast<double>(ChunkSizes(next->header(), extent).total());
  }
  parts.runs += static_cast<double>(patch->kept().vertices.size() + patch->kept().tets.size());
  meshes.plan = std::move(next);
  meshes.used = std::exchange(meshes.mesh, std::move(updated));
}

void begin_stable(const MeshPlan& plan, const TetMesh& mesh, StableMesh& stable) {
  if (!stable.begin(plan.header(), nullptr).ok()) std::abort();
  const auto from = const_cast<TetMesh&>(mesh).columns().all();
  const auto to = stable.place(whole_of(plan.header())).all();
  for (std::size_t column = 0; column < from.size(); ++column) {
    std::ranges::copy(from[column], to[column].begin());
  }
}

void remesh(benchmark::State& state, Solid solid, const BenchSize& size) {
  TaskPool pool(1);
  pool.run([&] {
    const auto volume = make_solid(solid, size);
    const std::vector<std::size_t> leaves = leaves_at_one_place(*volume);
    const auto changed = std::make_shared<const Volume>(inflated(*volume, leaves));
    Meshes meshes;
    for (const std::size_t leaf : leaves) meshes.replaced.push_back(volume->bricks[leaf]);
    meshes.plan = plan(volume);
    meshes.mesh = std::move(fill_mesh(*meshes.plan, {}, nullptr)->mesh);
    begin_stable(*meshes.plan, meshes.mesh, meshes.stable);
    Parts parts;
    for (const auto& next : {changed, volume})
      update_once(meshes, next, parts);  // touches memory
    parts = {};
    for (auto _ : state) {
      for (const auto& next : {changed, volume}) update_once(meshes, next, parts);
      state.PauseTiming();
      for (const auto& next : {changed, volume}) {
        const double start = now();
        benchmark::DoNotOptimize(fill_mesh(*plan(next), {}, nullptr));
        parts.whole += now() - start;
      }
      state.ResumeTiming();
    }
    const auto runs = 2 * static_cast<double>(state.iterations());
    const double both = parts.plan + parts.compare + parts.fill;
    state.counters["plan_ms"] = 1e3 * parts.plan / runs;
    state.counters["compare_ms"] = 1e3 * parts.compare / runs;
    state.counters["fill_ms"] = 1e3 * parts.fill / runs;
    state.counters["splice_ms"] = 1e3 * parts.splice / runs;
    state.counters["in_place_ms"] = 1e3 * parts.in_place / runs;
    state.counters["whole_ms"] = 1e3 * parts.whole / runs;
    state.counters["spliced"] = (both + parts.splice) / parts.whole;
    state.counters["in_place"] = (both + parts.in_place) / parts.whole;
    const MeshHeader& header = meshes.plan->header();
    state.counters["sent"] = parts.sent_tets / runs / static_cast<double>(header.tet_count);
    state.counters["sent_bytes"] =
        parts.sent_bytes / runs /
        static_cast<double>(ChunkSizes(header, whole_of(header)).total());
    state.counters["runs"] = parts.runs / runs;
    state.counters["renumbered"] = parts.renumbered / runs;
  });
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kMedium, kLarge, kHuge}) {
    for (const Solid solid : kSolids) {
      const std::string name = std::string("remesh/") + name_of(solid) + "/" + size.label;
      benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        remesh(state, solid, size);
      })->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
