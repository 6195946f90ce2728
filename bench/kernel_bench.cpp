// Each stage of the mesher alone, on one thread, in the order in which a mesh passes through
// them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/field/find_bricks.h"
#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/octree/octree.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/brick/survey.h"
#include "core/plan/make/mesher.h"
#include "core/plan/mesh_workspace.h"

namespace tet::bench {
namespace {

/// A solid, and what the stages before the measured one make of it.
struct Prepared {
  std::shared_ptr<const Volume> volume;
  PhiField field;
  FoundBricks found;
  Survey survey;

  Prepared(Solid solid, const BenchSize& size, double spacing_voxels)
      : volume(make_solid(solid, size)) {
    field.volume = volume.get();
    field.spacing_voxels = spacing_voxels;
    found = find_bricks(field).value();
    survey = survey_bricks(field, found.near_surface, {}, {}, nullptr).value();
  }

  Octree octree(int levels) const {
    return build_octree({survey.bricks, survey.finest}, field, survey.inside_test(),
                        {found.inside, {}}, {.max_levels = levels});
  }
};

/// Work per second beside the time: `items` of what `unit` says, in each iteration.
void count_items(benchmark::State& state, const char* unit, double items) {
  state.counters[unit] =
      benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate);
}

using Body = std::function<void(benchmark::State& state, const Prepared& prepared)>;

/// Registers `stage/solid/size`; all that it does happens on one thread.
void add(const std::string& stage,
         Solid solid,
         const BenchSize& size,
         const Body& body,
         double spacing_voxels = 1) {
  const std::string name = stage + "/" + name_of(solid) + "/" + size.label;
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    TaskPool pool(1);
    pool.run([&] { body(state, Prepared(solid, size, spacing_voxels)); });
  });
}

// Stages of the whole volume.

void find_the_bricks(benchmark::State& state, const Prepared& prepared) {
  for (auto _ : state) benchmark::DoNotOptimize(find_bricks(prepared.field));
  count_items(state, "regions/s", static_cast<double>(prepared.volume->regions.size()));
}

void survey(benchmark::State& state, const Prepared& prepared) {
  const auto& bricks = prepared.found.near_surface;
  for (auto _ : state) {
    benchmark::DoNotOptimize(survey_bricks(prepared.field, bricks, {}, {}, nullptr));
  }
  count_items(state, "bricks/s", static_cast<double>(bricks.size()));
}

void grow_octree(benchmark::State& state, const Prepared& prepared, int levels) {
  for (auto _ : state) benchmark::DoNotOptimize(prepared.octree(levels));
  count_items(state, "bricks/s", static_cast<double>(prepared.survey.bricks.size()));
}

void count_mesh(benchmark::State& state, const Prepared& prepared, int levels) {
  double bricks = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Survey survey = prepared.survey;
    Octree tree = prepared.octree(levels);
    state.ResumeTiming();
    const CountedMesh mesh({.field = prepared.field,
                            .survey = std::move(survey),
                            .tree = std::move(tree),
                            .uniform = levels == 0});
    bricks = static_cast<double>(mesh.brick_count());
  }
  count_items(state, "bricks/s", bricks);
}

// Stages of one brick near the surface.

/// Bricks spread over the surface; few, so that they stay in the cache as a task's one does.
std::vector<BrickCoord> some_surface_bricks(const Prepared& prepared) {
  constexpr std::size_t kBricks = 8;
  const auto& bricks = prepared.survey.bricks;
  std::vector<BrickCoord> some;
  for (std::size_t i = 0; i < kBricks; ++i) some.push_back(bricks[i * bricks.size() / kBricks]);
  return some;
}

using BrickStage = std::function<void(PhiSampler&, BrickCoord, StuffingWorkspace&)>;

void each_brick(benchmark::State& state, const Prepared& prepared, const BrickStage& stage) {
  const std::vector<BrickCoord> bricks = some_surface_bricks(prepared);
  const auto work = std::make_unique_for_overwrite<StuffingWorkspace[]>(bricks.size());
  PhiSampler sampler(prepared.field);
  for (std::size_t i = 0; i < bricks.size(); ++i)
    stuff_brick(sampler, bricks[i], {}, nullptr, work[i]);
  for (auto _ : state) {
    for (std::size_t i = 0; i < bricks.size(); ++i) stage(sampler, bricks[i], work[i]);
    benchmark::ClobberMemory();
  }
  count_items(state, "bricks/s", static_cast<double>(bricks.size()));
}

void sample(PhiSampler& sampler, BrickCoord brick, StuffingWorkspace& work) {
  sampler.sample(brick, work.samples);
}

void cut(PhiSampler& sampler, BrickCoord brick, StuffingWorkspace& work) {
  find_signs(work.samples, work.lattice.cuts.signs);
  find_cut_points(work.samples, sampler, brick, work.lattice.cuts);
}

void warp(PhiSampler&, BrickCoord, StuffingWorkspace& work) {
  warp_lattice(work.lattice.cuts, {}, work.lattice.warped);
}

void keep(PhiSampler&, BrickCoord, StuffingWorkspace& work) {
  const PlusAround plus(work.lattice.warped);
  benchmark::DoNotOptimize(keep_brick(work.lattice.warped, plus, {}));
  benchmark::DoNotOptimize(stuffed_cells(work.lattice.warped, plus, {}));
}

/// All of them in one workspace, brick after brick, as the survey does it.
void stuff_each(benchmark::State& state, const Prepared& prepared) {
  const std::vector<BrickCoord> bricks = some_surface_bricks(prepared);
  const auto work = std::make_unique_for_overwrite<StuffingWorkspace>();
  PhiSampler sampler(prepared.field);
  for (auto _ : state) {
    for (const BrickCoord brick : bricks) {
      benchmark::DoNotOptimize(stuff_brick(sampler, brick, {}, nullptr, *work));
    }
    benchmark::ClobberMemory();
  }
  count_items(state, "bricks/s", static_cast<double>(bricks.size()));
}

// Filling: one brick after another of a counted mesh.

bool is_surface_brick(const CountedMesh& mesh, BrickPlace place) {
  return place.level == 0 && mesh.touches_surface(place.brick);
}
bool is_inside_brick(const CountedMesh& mesh, BrickPlace place) {
  return place.level == 0 && !mesh.touches_surface(place.brick);
}
bool is_coarse_brick(const CountedMesh&, BrickPlace place) { return place.level > 0; }

using ChooseBrick = bool (*)(const CountedMesh& mesh, BrickPlace place);

/// Bricks with tets that `choose` likes.
std::vector<std::size_t> chosen_bricks(const CountedMesh& mesh, ChooseBrick choose) {
  std::vector<std::size_t> bricks;
  for (std::size_t i = 0; i < mesh.brick_count(); ++i) {
    if (mesh.first_tet(i + 1) > mesh.first_tet(i) && choose(mesh, mesh.place(i))) {
      bricks.push_back(i);
    }
  }
  return bricks;
}

void fill(benchmark::State& state, const Prepared& prepared, int levels, ChooseBrick choose) {
  const CountedMesh mesh({.field = prepared.field,
                          .survey = prepared.survey,
                          .tree = prepared.octree(levels),
                          .uniform = levels == 0});
  MeshWorkspace workspace;
  const LatticeToWorld to_world{prepared.volume->transform.linear, {}, false};
  const MeshHeader header;
  BrickFiller filler(mesh, prepared.field, header, to_world, Statistics::kMeasured,
                     workspace.get<BrickScratch>());
  std::vector<std::byte> positions, tets;
  const std::vector<std::size_t> bricks = chosen_bricks(mesh, choose);
  if (bricks.empty()) return state.SkipWithError("the mesh has no such brick");
  double filled = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    const std::size_t brick = bricks[next++ % bricks.size()];
    const std::uint64_t tet_count = mesh.first_tet(brick + 1) - mesh.first_tet(brick);
    positions.resize((mesh.first_vertex(brick + 1) - mesh.first_vertex(brick)) * 12);
    tets.resize(tet_count * 16);
    filler.fill(brick, {positions, tets, {}});
    filled += static_cast<double>(tet_count);
  }
  state.counters["tets/s"] = benchmark::Counter(filled, benchmark::Counter::kIsRate);
}

// What is measured of tets.

/// The tets of a brick whose nodes all moved a little.
struct ShakenBrick {
  std::vector<LocalPoint> points;
  std::vector<LocalTet> tets;

  ShakenBrick() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> step(-0.2F, 0.2F);
    for (const float centre : {0.0F, 0.5F}) {
      for (int i = 0; i < 1000; ++i) {
        const auto place = [&](int n) { return static_cast<float>(n) + centre + step(random); };
        points.push_back({place(i / 100), place(i / 10 % 10), place(i % 10)});
      }
    }
    constexpr std::array<int, 3> kStep{100, 10, 1};
    for (int i = 0; i < 1000; ++i) {
      if (i / 100 > 7 || i / 10 % 10 > 7 || i % 10 > 7) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        add_around_face(i, kStep[axis], kStep[(axis + 1) % 3], kStep[(axis + 2) % 3]);
    }
  }

 private:
  void add_around_face(int cell, int across, int u, int v) {
    const int face = cell + across;
    const std::array<int, 4> ring{face, face + u, face + u + v, face + v};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto id = [](int i) { return static_cast<std::uint16_t>(i); };
      tets.push_back({id(1000 + cell), id(1000 + face), id(ring[k]), id(ring[(k + 1) % 4])});
    }
  }
};

void measure_local_tets(benchmark::State& state) {
  const ShakenBrick brick;
  QualityMeter meter;
  for (auto _ : state) meter.add_tets(brick.points.data(), brick.tets);
  benchmark::DoNotOptimize(meter.stats());
  count_items(state, "tets/s", static_cast<double>(brick.tets.size()));
}

using MeasureMesh = std::function<void(const TetMesh&)>;

void measure(benchmark::State& state,
             const Prepared& prepared,
             const MeasureMesh& measure_mesh,
             CoordinateType coordinates = CoordinateType::kFloat32) {
  TaskPool pool(1);
  MeshRequest request;
  request.levels = 0;
  request.coordinates = coordinates;
  const MeshResult result =
      mesh_volume(pool, {.shape = prepared.volume, .request = request}).value();
  for (auto _ : state) measure_mesh(result.mesh);
  count_items(state, "tets/s", static_cast<double>(result.mesh.header.tet_count));
}

void add_stages(Solid solid, const BenchSize& size) {
  using namespace std::placeholders;
  add("find_bricks", solid, size, find_the_bricks);
  add("survey", solid, size, survey);
  add("octree_uniform", solid, size, std::bind(grow_octree, _1, _2, 0));
  add("octree_graded", solid, size, std::bind(grow_octree, _1, _2, kMaxLevels));
  add("count_uniform", solid, size, std::bind(count_mesh, _1, _2, 0));
  add("count_graded", solid, size, std::bind(count_mesh, _1, _2, kMaxLevels));
  const auto add_measure = [&](const char* stage, const MeasureMesh& body, auto coordinates) {
    add(stage, solid, size, std::bind(measure, _1, _2, body, coordinates));
  };
  add_measure("measure_quality", measure_quality, CoordinateType::kFloat32);
  add_measure("measure_quality_float64", measure_quality, CoordinateType::kFloat64);
  add_measure("measure_boundary", measure_boundary, CoordinateType::kFloat32);
}

/// The smallest size at which a ball has bricks far inside, and coarse ones.
constexpr BenchSize kWithInside{"5e5", 5e5};

void add_brick_stages() {
  using namespace std::placeholders;
  benchmark::RegisterBenchmark("measure_local_tets", measure_local_tets);
  const auto add_here = [](const char* stage, Solid solid, const Body& body) {
    add(stage, solid, kWithInside, body);
  };
  add_here("brick_sample", Solid::kGyroid, std::bind(each_brick, _1, _2, sample));
  add_here("brick_cut_points", Solid::kGyroid, std::bind(each_brick, _1, _2, cut));
  add_here("brick_warp", Solid::kGyroid, std::bind(each_brick, _1, _2, warp));
  add_here("brick_stuff", Solid::kGyroid, stuff_each);
  add_here("brick_keep", Solid::kGyroid, std::bind(each_brick, _1, _2, keep));
  const auto add_off_voxels = [](const char* stage, const Body& body) {
    constexpr double kSpacingVoxels = 1.5;
    add(stage, Solid::kGyroid, kWithInside, body, kSpacingVoxels);
  };
  add_off_voxels("brick_sample_1.5_voxels", std::bind(each_brick, _1, _2, sample));
  add_off_voxels("brick_cut_points_1.5_voxels", std::bind(each_brick, _1, _2, cut));
  add_off_voxels("brick_stuff_1.5_voxels", stuff_each);
  add_here("fill_surface", Solid::kGyroid, std::bind(fill, _1, _2, 0, is_surface_brick));
  add_here("fill_inside", Solid::kBall, std::bind(fill, _1, _2, 0, is_inside_brick));
  add_here("fill_coarse", Solid::kBall, std::bind(fill, _1, _2, kMaxLevels, is_coarse_brick));
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  add_brick_stages();
  for (const BenchSize& size : {kSmall, kMedium}) {
    add_stages(Solid::kBall, size);
    add_stages(Solid::kGyroid, size);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
