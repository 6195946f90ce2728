// What named boundary faces cost: the mesh without them beside the mesh with them, in turn, on
// one thread and in fresh memory, by the processor's time. Medians: a busy machine matters
// little.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"

namespace tet::bench {
namespace {

/// One way of meshing, with faces or without.
class Meshes {
 public:
  Meshes(TaskPool& pool, std::shared_ptr<const Volume> volume, MeshRequest request, bool faces)
      : pool_(pool), volume_(std::move(volume)), request_(std::move(request)) {
    request_.faces = faces;
  }

  void make_one() {
    const std::clock_t start = std::clock();
    const auto mesh = mesh_volume(pool_, {.shape = volume_, .request = request_});
    seconds_.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    if (!mesh.ok()) return;
    tets_ = mesh->mesh.header.tet_count;
    faces_ = mesh->mesh.header.face_count;
  }
  double tets() const { return static_cast<double>(tets_); }
  double faces() const { return static_cast<double>(faces_); }
  /// Returns the median of one mesh, or 0 where none was made.
  double seconds() {
    if (seconds_.empty()) return 0;
    const auto middle = seconds_.begin() + static_cast<std::ptrdiff_t>(seconds_.size() / 2);
    std::nth_element(seconds_.begin(), middle, seconds_.end());
    return *middle;
  }

 private:
  TaskPool& pool_;
  std::shared_ptr<const Volume> volume_;
  MeshRequest request_;
  std::uint64_t tets_ = 0, faces_ = 0;
  std::vector<double> seconds_;
};

void compare(benchmark::State& state,
             const std::shared_ptr<const Volume>& volume,
             const MeshRequest& request) {
  TaskPool pool(1);
  Meshes without(pool, volume, request, false), with(pool, volume, request, true);
  for (auto _ : state) {
    without.make_one();
    with.make_one();
  }
  state.counters["tets"] = with.tets();
  state.counters["faces"] = with.faces();
  state.counters["without_ms"] = 1e3 * without.seconds();
  state.counters["with_ms"] = 1e3 * with.seconds();
  state.counters["cost_percent"] = 100 * (with.seconds() / without.seconds() - 1);
}

std::vector<std::pair<std::string, MeshRequest>> requests() {
  MeshRequest graded, uniform, bare, both_sides, graded_surface;
  uniform.levels = 0;
  bare.skip_statistics = true;
  both_sides.preset = Preset::kBothSides;
  graded_surface.sizing.grade_surface = true;
  graded_surface.sizing.coarsest = 8;
  return {{"graded", graded},
          {"uniform", uniform},
          {"bare", bare},
          {"both_sides", both_sides},
          {"graded_surface", graded_surface}};
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const Solid solid : kSolids) {
    for (const auto& [name, request] : requests()) {
      const std::string full = "faces/" + std::string(name_of(solid)) + "/" + name;
      const auto run = [solid = solid, request = request](benchmark::State& state) {
        compare(state, make_solid(solid, kMedium), request);
      };
      benchmark::RegisterBenchmark(full.c_str(), run)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
