// A volume for the price of its surface: our graded tets of a level set beside the surface
// alone by OpenVDB's volumeToMesh, on the same threads, in turn. Nobody measures that surface:
// so the tets alone, too, beside the mesh with its statistics.
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "bench/checked.h"
#include "bench/openvdb_surface.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"

namespace tet::bench {
namespace {

using MakeVolume = std::function<std::shared_ptr<const Volume>()>;

/// What some work takes, run by run.
class Spent {
 public:
  template <class Work>
  void add(const Work& work) {
    using Clock = std::chrono::steady_clock;
    const double cpu_before = process_cpu_seconds();
    const auto start = Clock::now();
    work();
    real_.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    cpu_.push_back(process_cpu_seconds() - cpu_before);
  }
  /// Medians of seconds.
  double real() const { return median(real_); }
  double cpu() const { return median(cpu_); }

 private:
  static double median(std::vector<double> seconds) {
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
  }

  std::vector<double> real_, cpu_;
};

/// Graded meshes, in fresh memory or in that of the mesh before.
class GradedMeshes {
 public:
  GradedMeshes(TaskPool& pool, std::shared_ptr<const Volume> volume, bool skip_statistics)
      : pool_(pool), volume_(std::move(volume)) {
    request_.skip_statistics = skip_statistics;
  }

  void reuse_memory() {
    reuse_ = true;
    make_one();
    spent_ = {};
  }
  void make_one() {
    spent_.add([&] {
      MeshResult made = checked(mesh_volume(
          pool_, {.shape = volume_, .request = request_, .used = std::move(last_)}));
      tets_ = static_cast<double>(made.mesh.header.tet_count);
      if (reuse_) last_ = std::move(made.mesh);
    });
  }
  double tets() const { return tets_; }
  const Spent& spent() const { return spent_; }

 private:
  TaskPool& pool_;
  std::shared_ptr<const Volume> volume_;
  MeshRequest request_;
  bool reuse_ = false;
  TetMesh last_;
  double tets_ = 0;
  Spent spent_;
};

/// All on one volume, in turn, so that a busy machine slows each.
void compare(benchmark::State& state, const MakeVolume& make_volume, int threads) {
  const std::shared_ptr<const Volume> volume = make_volume();
  if (volume == nullptr) return state.SkipWithError("glmark2-data is not installed");
  const OpenVdbSurface openvdb(*volume);
  TaskPool pool(threads);
  GradedMeshes alone(pool, volume, true), measured(pool, volume, false);
  GradedMeshes again(pool, volume, true), measured_again(pool, volume, false);
  again.reuse_memory();
  measured_again.reuse_memory();
  double triangles = 0;
  Spent surface;
  const auto make_surface = [&] {
    surface.add(
        [&] { pool.run([&] { triangles = static_cast<double>(openvdb.count_triangles()); }); });
  };
  for (auto _ : state) {
    // What is made before leaves memory behind, or does not: the same before either.
    alone.make_one();
    make_surface();
    measured.make_one();
    make_surface();
    again.make_one();
    measured_again.make_one();
  }
  state.counters["tets"] = alone.tets();
  state.counters["tets_ms"] = 1e3 * alone.spent().real();
  state.counters["tets/s"] = alone.tets() / alone.spent().real();
  state.counters["triangles"] = triangles;
  state.counters["surface_ms"] = 1e3 * surface.real();
  state.counters["triangles/s"] = triangles / surface.real();
  state.counters["times_surface"] = alone.spent().real() / surface.real();
  state.counters["measured_times_surface"] = measured.spent().real() / surface.real();
  state.counters["cpu_ms"] = 1e3 * alone.spent().cpu();
  state.counters["cpu_surface_ms"] = 1e3 * surface.cpu();
  state.counters["cpu_times_surface"] = alone.spent().cpu() / surface.cpu();
  state.counters["cpu_measured"] = measured.spent().cpu() / surface.cpu();
  state.counters["cpu_again"] = again.spent().cpu() / surface.cpu();
  state.counters["cpu_again_measured"] = measured_again.spent().cpu() / surface.cpu();
}

/// Registers `price/volume/threads:n`.
void add_volume(const std::string& name, const MakeVolume& make_volume) {
  for (const int threads : {1, 2}) {
    const std::string full = "price/" + name + "/threads:" + std::to_string(threads);
    benchmark::RegisterBenchmark(
        full.c_str(), [=](benchmark::State& state) { compare(state, make_volume, threads); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kMedium, kLarge}) {
    for (const Solid solid : kSolids) {
      add_volume(std::string(name_of(solid)) + "/" + size.label,
                 [=] { return make_solid(solid, size); });
    }
  }
  add_volume("bunny/2e5", [] { return make_bunny(0.046); });
  add_volume("bunny/2.5e6", [] { return make_bunny(0.02); });
  add_volume("bunny/1e7", [] { return make_bunny(0.0126); });
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
