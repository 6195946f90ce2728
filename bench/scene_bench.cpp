// Scenes: phi of a grid's leaf beside a primitive's, point by point; and a mesh of one leaf
// beside that of the grid itself and of the primitive that the grid was made of. One thread.
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"
#include "core/scene/scene.h"
#include "core/scene/scene_evaluator.h"

namespace tet::bench {
namespace {

template <class Kind>
std::shared_ptr<const Scene> scene_of(Kind kind) {
  scene::Description description;
  description.nodes.push_back({"", std::move(kind)});
  return std::make_shared<const Scene>(*make_scene(description));
}

scene::GridSolid leaf(std::shared_ptr<const Volume> volume) {
  return {"", "", {}, std::move(volume)};
}

/// The radius of a ball's grid.
double radius_of(const Volume& ball) {
  const auto [min, max] = scene_of(leaf(std::make_shared<const Volume>(ball)))->extent;
  return (max.x - min.x) / 2 - 1;
}

/// Slices of a brick and its halo, one brick after another along a line through the solid.
void evaluate_slices(benchmark::State& state, const Scene& scene, double spacing) {
  constexpr std::size_t kEdge = 13;
  SceneEvaluator evaluator(scene);
  scene::Points points;
  std::int64_t slice = 0;
  for (auto _ : state) {
    const auto first = static_cast<double>(slice++ % 400 - 200);
    for (std::size_t i = 0; i < kEdge * kEdge; ++i) {
      const std::size_t row = i / kEdge;
      points.x[i] = spacing * first;
      points.y[i] = spacing * static_cast<double>(row);
      points.z[i] = spacing * (first + static_cast<double>(i % kEdge));
    }
    benchmark::DoNotOptimize(evaluator.evaluate(points, kEdge * kEdge));
  }
  state.counters["points/s"] = benchmark::Counter(static_cast<double>(slice) * kEdge * kEdge,
                                                  benchmark::Counter::kIsRate);
}

void bound_cubes(benchmark::State& state, const Scene& scene, double half_edge) {
  SceneEvaluator evaluator(scene);
  scene::Points points;
  std::int64_t column = 0;
  for (auto _ : state) {
    const auto first = static_cast<double>(column++ % 400 - 200);
    for (std::size_t i = 0; i < 64; ++i) {
      const std::size_t slice = i / 16;
      points.x[i] = first + half_edge * static_cast<double>(slice);
      points.y[i] = half_edge * static_cast<double>(i / 4 % 4);
      points.z[i] = half_edge * static_cast<double>(i % 4);
    }
    benchmark::DoNotOptimize(evaluator.bounds(points, 64, half_edge).low.at[0]);
  }
  state.counters["cubes/s"] =
      benchmark::Counter(static_cast<double>(column) * 64, benchmark::Counter::kIsRate);
}

void mesh(benchmark::State& state, const Shape& shape, double spacing) {
  TaskPool pool(1);
  MeshRequest request;
  request.spacing = spacing;
  double tets = 0, plan_seconds = 0, fill_seconds = 0, runs = 0;
  for (auto _ : state) {
    const auto result = mesh_volume(pool, {.shape = shape, .request = request});
    if (!result.ok()) return state.SkipWithError(result.status().ToString().c_str());
    tets += static_cast<double>(result->mesh.header.tet_count);
    plan_seconds += result->plan_seconds;
    fill_seconds += result->fill_seconds;
    ++runs;
  }
  state.counters["tets/s"] = benchmark::Counter(tets, benchmark::Counter::kIsRate);
  state.counters["plan_s"] = plan_seconds / runs;
  state.counters["fill_s"] = fill_seconds / runs;
}

void register_points() {
  const auto ball = make_solid(Solid::kBall, kMedium);
  const auto of_grid = scene_of(leaf(ball)),
             of_sphere = scene_of(scene::Sphere{radius_of(*ball)});
  const auto points = [](const char* kind, std::shared_ptr<const Scene> scene, double spacing) {
    benchmark::RegisterBenchmark(("points/" + std::string(kind)).c_str(),
                                 [scene = std::move(scene), spacing](auto& state) {
                                   evaluate_slices(state, *scene, spacing);
                                 });
  };
  points("sphere", of_sphere, 1);
  points("grid", of_grid, 1);
  points("grid_finer", of_grid, 0.37);
  points("grid_coarser", of_grid, 2.7);
  const auto bounds = [](const char* kind, const std::shared_ptr<const Scene>& scene) {
    for (const double half_edge : {1.5, 6.0, 48.0}) {
      benchmark::RegisterBenchmark(
          ("bounds/" + std::string(kind) + "/" + std::to_string(half_edge)).c_str(),
          [scene, half_edge](auto& state) { bound_cubes(state, *scene, half_edge); });
    }
  };
  bounds("sphere", of_sphere);
  bounds("grid", of_grid);
}

void register_meshes() {
  for (const BenchSize& size : {kSmall, kMedium}) {
    for (const Solid solid : {Solid::kBall, Solid::kGyroid}) {
      const auto volume = make_solid(solid, size);
      const auto add = [&](const std::string& way, const Shape& shape, double spacing) {
        const std::string name =
            std::string("mesh/") + name_of(solid) + "/" + size.label + "/" + way;
        benchmark::RegisterBenchmark(name.c_str(), [shape, spacing](auto& state) {
          mesh(state, shape, spacing);
        })->Unit(benchmark::kMillisecond);
      };
      for (const double spacing : {1.0, 0.9}) {
        const std::string at = spacing == 1 ? "" : "_between";
        add("grid" + at, volume, spacing);
        add("leaf" + at, scene_of(leaf(volume)), spacing);
        if (solid == Solid::kBall) {
          add("sphere" + at, scene_of(scene::Sphere{radius_of(*volume)}), spacing);
        }
      }
    }
  }
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  tet::bench::register_points();
  tet::bench::register_meshes();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
