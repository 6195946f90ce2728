// The whole mesh in this process: every solid and size, uniform and graded, on one thread and
// on two.
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "bench/peak_memory.h"
#include "core/base/parallel.h"
#include "core/pipeline/mesher.h"

namespace tet::bench {
namespace {

using MakeVolume = std::function<std::shared_ptr<const Volume>()>;

/// What is meshed, and how.
struct PipelineCase {
  std::string volume_name;
  MakeVolume make_volume;
  int levels = 0;
  int threads = 1;
};

double process_cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// What the runs of one benchmark add up to.
struct Totals {
  double runs = 0, tets = 0, plan_seconds = 0, fill_seconds = 0, column_bytes = 0;

  void add(const MeshResult& result) {
    ++runs;
    tets += static_cast<double>(result.mesh.header.tet_count);
    plan_seconds += result.plan_seconds;
    fill_seconds += result.fill_seconds;
    column_bytes += static_cast<double>(result.mesh.positions.size() + result.mesh.tets.size());
  }
};

void report(benchmark::State& state,
            const Totals& totals,
            double cpu_seconds,
            double peak_bytes) {
  state.counters["tets"] = totals.tets / totals.runs;
  state.counters["tets/s"] = benchmark::Counter(totals.tets, benchmark::Counter::kIsRate);
  state.counters["tets/cpu_s"] = totals.tets / cpu_seconds;
  state.counters["plan_s"] = totals.plan_seconds / totals.runs;
  state.counters["fill_s"] = totals.fill_seconds / totals.runs;
  state.counters["bytes/tet"] = totals.column_bytes / totals.tets;
  state.counters["peak_bytes/tet"] = peak_bytes * totals.runs / totals.tets;
}

/// The volume of a case; the last one is kept, as several cases in a row share it.
std::shared_ptr<const Volume> volume_of(const PipelineCase& run) {
  static std::string kept_name;
  static std::shared_ptr<const Volume> kept;
  if (kept_name != run.volume_name) {
    kept = run.make_volume();
    kept_name = run.volume_name;
  }
  return kept;
}

/// Meshes into fresh memory each time, and gives it back: what a caller pays for one mesh.
void mesh(benchmark::State& state, const PipelineCase& run) {
  const std::shared_ptr<const Volume> volume = volume_of(run);
  if (volume == nullptr) return state.SkipWithError("glmark2-data is not installed");
  TaskPool pool(run.threads);
  MeshRequest request;
  request.levels = run.levels;
  Totals totals;
  const PeakMemory memory;
  const double cpu_before = process_cpu_seconds();
  for (auto _ : state) {
    const auto result = mesh_volume(pool, volume, request, {}, {}, nullptr);
    if (!result.ok()) return state.SkipWithError(result.status().ToString().c_str());
    totals.add(*result);
  }
  report(state, totals, process_cpu_seconds() - cpu_before, memory.peak_bytes());
}

/// Registers `mesh/volume/grading/threads:n`.
void add_case(const PipelineCase& run) {
  const std::string name = "mesh/" + run.volume_name +
                           (run.levels == 0 ? "/uniform" : "/graded") +
                           "/threads:" + std::to_string(run.threads);
  benchmark::RegisterBenchmark(name.c_str(), [run](benchmark::State& s) { mesh(s, run); })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void add_volume(const std::string& name, const MakeVolume& make_volume) {
  for (const int levels : {0, kMaxLevels}) {
    for (const int threads : {1, 2}) add_case({name, make_volume, levels, threads});
  }
}

void add_solid(Solid solid, const BenchSize& size) {
  add_volume(std::string(name_of(solid)) + "/" + size.label,
             [=] { return make_solid(solid, size); });
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kMedium, kLarge}) {
    for (const Solid solid : kSolids) add_solid(solid, size);
  }
  add_volume("bunny/2e5", [] { return make_bunny(0.046); });
  add_volume("bunny/2.5e6", [] { return make_bunny(0.02); });  // the demo's own
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
