// Arrays from one mesh to another: points located and interpolated a second, on one thread.
#include <cstdint>
#include <string>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"
#include "core/remap/linear_transfer.h"
#include "core/remap/transfer.h"

namespace tet::bench {
namespace {

/// A uniform mesh of the benchmark's ball, and its points' coordinates as arrays.
DataMesh ball_mesh(const BenchSize& size, double spacing) {
  DataMesh mesh;
  TaskPool pool(0);
  MeshRequest request;
  request.levels = 1;
  request.spacing = spacing;
  const auto made =
      mesh_volume(pool, {.shape = make_solid(Solid::kBall, size), .request = request});
  if (!made.ok()) return mesh;
  const TetMesh& tets = made->mesh;
  for (std::uint64_t i = 0; i < tets.header.vertex_count; ++i) {
    mesh.points.push_back(tets.vertex(i));
  }
  for (std::uint64_t i = 0; i < tets.header.tet_count; ++i) {
    const auto [a, b, c, d] = tets.tet(i);
    const auto id = [](std::uint64_t vertex) { return static_cast<std::uint32_t>(vertex); };
    mesh.tets.push_back({id(a), id(b), id(c), id(d)});
  }
  DataArray heat{.name = "heat", .values = {}}, load{.name = "load", .values = {}};
  for (const WorldPoint& p : mesh.points) heat.values.push_back(p.x + p.y);
  load.values.assign(mesh.tets.size(), 1);
  mesh.point_data = {heat};
  mesh.cell_data = {load};
  return mesh;
}

void transfer_points(benchmark::State& state, const BenchSize& size) {
  const DataMesh from = ball_mesh(size, 1), to = ball_mesh(size, 1.07);
  if (from.tets.empty()) return state.SkipWithError("no mesh");
  TaskPool pool(1);
  pool.run([&] {
    const TetLocator locator(from);
    const Table table = table_of({&from.point_data[0]});
    for (auto _ : state) {
      Outside outside;
      benchmark::DoNotOptimize(sample_at_points(locator, table, to.points, false, {}, outside));
    }
  });
  const auto points = static_cast<double>(to.points.size());
  state.counters["points/s"] =
      benchmark::Counter(points, benchmark::Counter::kIsIterationInvariantRate);
}

void build_locator(benchmark::State& state, const BenchSize& size) {
  const DataMesh from = ball_mesh(size, 1);
  if (from.tets.empty()) return state.SkipWithError("no mesh");
  TaskPool pool(1);
  pool.run([&] {
    for (auto _ : state) benchmark::DoNotOptimize(TetLocator(from));
  });
  state.counters["tets/s"] = benchmark::Counter(static_cast<double>(from.tets.size()),
                                                benchmark::Counter::kIsIterationInvariantRate);
}

void conserve(benchmark::State& state, const BenchSize& size) {
  const DataMesh from = ball_mesh(size, 1), to = ball_mesh(size, 1.07);
  if (from.tets.empty()) return state.SkipWithError("no mesh");
  TaskPool pool(1);
  pool.run([&] {
    for (auto _ : state) {
      benchmark::DoNotOptimize(transfer(from, to, {.mode = TransferMode::kConservative}));
    }
  });
  state.counters["tets/s"] = benchmark::Counter(static_cast<double>(to.tets.size()),
                                                benchmark::Counter::kIsIterationInvariantRate);
}

using Body = void (*)(benchmark::State& state, const BenchSize& size);

void add(const char* what, const BenchSize& size, Body body) {
  const std::string name = std::string(what) + "/ball/" + size.label + "/threads:1";
  // The pool's thread works, not the one that is measured by default.
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    body(state, size);
  })->MeasureProcessCPUTime();
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kMedium}) {
    add("locator", size, build_locator);
    add("points", size, transfer_points);
    add("conserve", size, conserve);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
