// The whole mesh in this process: every solid and size, uniform and graded, on one thread and
// on two; and the default mesh improved.
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "bench/checked.h"
#include "bench/peak_memory.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"

namespace tet::bench {
namespace {

using MakeVolume = std::function<std::shared_ptr<const Volume>()>;

/// What is meshed, and how.
struct PipelineCase {
  std::string volume_name;
  MakeVolume make_volume;
  MeshRequest request;
  int threads = 1;
  bool reuse = false;  ///< the memory of the mesh before
};

/// What the runs of one benchmark add up to.
struct Totals {
  double runs = 0, tets = 0, plan_seconds = 0, fill_seconds = 0, column_bytes = 0;
  double improve_seconds = 0;

  void add(const MeshResult& result) {
    ++runs;
    tets += static_cast<double>(result.mesh.header.tet_count);
    plan_seconds += result.plan_seconds;
    fill_seconds += result.fill_seconds;
    improve_seconds += result.improve_seconds;
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

/// How much longer an improved mesh takes, and what it gains.
void report_improvement(benchmark::State& state, const Totals& totals, const MeshResult& last) {
  const double meshing = totals.plan_seconds + totals.fill_seconds;
  state.counters["improve_s"] = totals.improve_seconds / totals.runs;
  state.counters["times_meshing"] = (meshing + totals.improve_seconds) / meshing;
  state.counters["min_before_deg"] = last.improvement->min_dihedral_before_deg;
  state.counters["min_after_deg"] = last.quality.min_dihedral_deg;
  state.counters["max_before_deg"] = last.improvement->max_dihedral_before_deg;
  state.counters["max_after_deg"] = last.quality.max_dihedral_deg;
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

/// Meshes into fresh memory each time, and gives it back: what a caller pays for one mesh. Or
/// into the memory of the mesh before: what a caller pays who makes many.
void mesh(benchmark::State& state, const PipelineCase& run) {
  const std::shared_ptr<const Volume> volume = volume_of(run);
  if (volume == nullptr) return state.SkipWithError("glmark2-data is not installed");
  TaskPool pool(run.threads);
  const auto make = [&](TetMesh used) {
    return mesh_volume(pool,
                       {.shape = volume, .request = run.request, .used = std::move(used)});
  };
  Totals totals;
  MeshResult last;
  if (run.reuse) last = checked(make({}));
  const PeakMemory memory;
  const double cpu_before = process_cpu_seconds();
  for (auto _ : state) {
    TetMesh used = run.reuse ? std::move(last.mesh) : TetMesh{};
    last = {};
    auto result = make(std::move(used));
    if (!result.ok()) return state.SkipWithError(result.status().ToString().c_str());
    totals.add(*result);
    last = *std::move(result);
  }
  report(state, totals, process_cpu_seconds() - cpu_before, memory.peak_bytes());
  if (run.request.improve) report_improvement(state, totals, last);
}

/// Registers `mesh/volume/kind/threads:n`.
void add_case(const PipelineCase& run, const std::string& kind) {
  const std::string name =
      "mesh/" + run.volume_name + "/" + kind + "/threads:" + std::to_string(run.threads);
  benchmark::RegisterBenchmark(name.c_str(), [run](benchmark::State& s) { mesh(s, run); })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void add_volume(const std::string& name, const MakeVolume& make_volume) {
  const MeshRequest graded;
  MeshRequest uniform, improved;
  uniform.levels = 0;
  improved.improve = true;
  const auto mesh_only = [](MeshRequest request) {
    request.skip_statistics = true;
    return request;
  };
  for (const int threads : {1, 2}) add_case({name, make_volume, uniform, threads}, "uniform");
  for (const int threads : {1, 2}) add_case({name, make_volume, graded, threads}, "graded");
  for (const int threads : {1, 2}) {
    add_case({name, make_volume, uniform, threads, true}, "uniform_again");
    add_case({name, make_volume, graded, threads, true}, "graded_again");
    add_case({name, make_volume, mesh_only(uniform), threads, true}, "uniform_only");
    add_case({name, make_volume, mesh_only(graded), threads, true}, "graded_only");
  }
  for (const int threads : {1, 2}) add_case({name, make_volume, improved, threads}, "improved");
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
