// A mesh of a grid of which one leaf in a hundred changed, from the mesh before: counting,
// finding what is kept, making the rest and splicing it in, beside making the whole mesh.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/mesh/splice.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"
#include "core/transfer/mesh_patch.h"

namespace tet::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Plan = std::shared_ptr<const MeshPlan>;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The volume with the hundredth of its leaves that lies nearest to one of them a little
/// inflated.
Volume inflated_at_one_place(const Volume& volume) {
  Volume changed = volume;
  const BrickCoord centre = volume.bricks[volume.bricks.size() / 3];
  const auto distance = [&](std::size_t i) {
    const BrickCoord b = volume.bricks[i];
    return std::hypot(b.x - centre.x, b.y - centre.y, b.z - centre.z);
  };
  std::vector<std::size_t> order(volume.bricks.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, distance);
  order.resize(order.size() / 100 + 1);
  for (const std::size_t brick : order) {
    for (std::size_t v = brick * kBrickCells; v < (brick + 1) * kBrickCells; ++v) {
      changed.values[v] = std::max(changed.values[v] - 0.2F, -changed.background);
    }
    const auto values = std::span(changed.values).subspan(brick * kBrickCells, kBrickCells);
    const auto [min, max] = std::ranges::minmax(values);
    changed.ranges[brick] = {min, max};
  }
  return changed;
}

Plan plan(const std::shared_ptr<const Volume>& volume, const MeshPlan* earlier = nullptr) {
  return plan_mesh({.shape = volume, .earlier = earlier}).value();
}

/// Seconds of one update, by part.
struct Parts {
  double plan = 0, compare = 0, fill = 0, splice = 0, whole = 0;
};

/// Updates as a session does: `updated` becomes the new mesh, in the memory of the one it was.
void update_once(const Plan& earlier,
                 const TetMesh& mesh,
                 const std::shared_ptr<const Volume>& volume,
                 TetMesh& updated,
                 Parts& parts,
                 double& sent_tets) {
  auto start = Clock::now();
  const Plan now = plan(volume, earlier.get());
  parts.plan += seconds_since(start);
  start = Clock::now();
  const auto patch = MeshPatch::between(as_bricks(earlier), as_bricks(now));
  parts.compare += seconds_since(start);
  start = Clock::now();
  updated = splice_mesh(mesh, now->header(), patch->kept(), std::move(updated)).value();
  parts.splice += seconds_since(start);
  start = Clock::now();
  for_each_range(patch->patch_count(), 1, [&](std::size_t begin, std::size_t end) {
    MeshWorkspace workspace;
    for (std::size_t i = begin; i < end; ++i) {
      patch->fill(i, workspace, updated.columns_of(patch->extent(i)));
    }
  });
  parts.fill += seconds_since(start);
  for (std::uint64_t i = 0; i < patch->patch_count(); ++i) {
    sent_tets += static_cast<double>(patch->extent(i).tet_count);
  }
}

void remesh(benchmark::State& state, Solid solid, const BenchSize& size) {
  TaskPool pool(1);
  pool.run([&] {
    const auto volume = make_solid(solid, size);
    const auto changed = std::make_shared<const Volume>(inflated_at_one_place(*volume));
    const Plan earlier = plan(volume);
    const TetMesh mesh = std::move(fill_mesh(*earlier, {}, nullptr)->mesh);
    TetMesh updated(mesh.header);
    Parts parts;
    double sent = 0;
    update_once(earlier, mesh, changed, updated, parts, sent);  // touches its memory
    parts = {};
    sent = 0;
    for (auto _ : state) {
      update_once(earlier, mesh, changed, updated, parts, sent);
      state.PauseTiming();
      const auto start = Clock::now();
      benchmark::DoNotOptimize(fill_mesh(*plan(changed), {}, nullptr));
      parts.whole += seconds_since(start);
      state.ResumeTiming();
    }
    const auto runs = static_cast<double>(state.iterations());
    const double update = parts.plan + parts.compare + parts.fill + parts.splice;
    state.counters["plan_ms"] = 1e3 * parts.plan / runs;
    state.counters["compare_ms"] = 1e3 * parts.compare / runs;
    state.counters["fill_ms"] = 1e3 * parts.fill / runs;
    state.counters["splice_ms"] = 1e3 * parts.splice / runs;
    state.counters["whole_ms"] = 1e3 * parts.whole / runs;
    state.counters["times_whole"] = update / parts.whole;
    state.counters["sent"] = sent / runs / static_cast<double>(earlier->header().tet_count);
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
