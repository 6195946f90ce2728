// A volume for the price of its surface: our graded tets of a level set beside the surface
// alone by OpenVDB's volumeToMesh, on the same threads, in turn. Nobody measures that surface:
// so the tets alone, too, beside the mesh with its statistics.
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "bench/openvdb_surface.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"

namespace tet::bench {
namespace {

using MakeVolume = std::function<std::shared_ptr<const Volume>()>;

/// Real seconds that `work` takes.
template <class Work>
double seconds_of(const Work& work) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Graded meshes in fresh memory.
class GradedMeshes {
 public:
  GradedMeshes(TaskPool& pool, std::shared_ptr<const Volume> volume, bool skip_statistics)
      : pool_(pool), volume_(std::move(volume)) {
    request_.skip_statistics = skip_statistics;
  }

  void make_one() {
    seconds_ += seconds_of([&] {
      const auto mesh = mesh_volume(pool_, {.shape = volume_, .request = request_});
      if (mesh.ok()) tets_ += static_cast<double>(mesh->mesh.header.tet_count);
    });
  }
  double tets() const { return tets_; }
  double seconds() const { return seconds_; }

 private:
  TaskPool& pool_;
  std::shared_ptr<const Volume> volume_;
  MeshRequest request_;
  double tets_ = 0, seconds_ = 0;
};

/// All on one volume, in turn, so that a busy machine slows each.
void compare(benchmark::State& state, const MakeVolume& make_volume, int threads) {
  const std::shared_ptr<const Volume> volume = make_volume();
  if (volume == nullptr) return state.SkipWithError("glmark2-data is not installed");
  const OpenVdbSurface openvdb(*volume);
  TaskPool pool(threads);
  GradedMeshes alone(pool, volume, true), measured(pool, volume, false);
  double triangles = 0, surface_seconds = 0;
  const auto make_surface = [&] {
    surface_seconds += seconds_of([&] {
      pool.run([&] { triangles += static_cast<double>(openvdb.count_triangles()); });
    });
  };
  for (auto _ : state) {
    // What is made before leaves memory behind, or does not: the same before either.
    alone.make_one();
    make_surface();
    measured.make_one();
    make_surface();
  }
  const auto meshes = static_cast<double>(state.iterations()), runs = 2 * meshes;
  state.counters["tets"] = alone.tets() / meshes;
  state.counters["tets_ms"] = 1e3 * alone.seconds() / meshes;
  state.counters["tets/s"] = alone.tets() / alone.seconds();
  state.counters["triangles"] = triangles / runs;
  state.counters["surface_ms"] = 1e3 * surface_seconds / runs;
  state.counters["triangles/s"] = triangles / surface_seconds;
  state.counters["times_surface"] = 2 * alone.seconds() / surface_seconds;
  state.counters["measured_times_surface"] = 2 * measured.seconds() / surface_seconds;
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
