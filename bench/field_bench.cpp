// What it costs to give a mesh the values of other grids: filling it with and without, and
// sampling alone. One thread.
#include <array>
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
#include "core/plan/brick/brick_plan.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/volume/volume_builder.h"

namespace tet::bench {
namespace {

/// The fields of a mesh: so many, each of one component or three, in voxels so wide.
struct FieldKind {
  const char* label;
  std::size_t fields, components;
  double voxel;
};
constexpr std::array kKinds{
    FieldKind{"none", 0, 1, 1.37},        FieldKind{"scalar", 1, 1, 1.37},
    FieldKind{"fine_scalar", 1, 1, 0.61}, FieldKind{"vector", 1, 3, 1.37},
    FieldKind{"scalars", 8, 1, 1.37},
};

/// Values in every voxel of a box, off the solid's lattice.
std::shared_ptr<const Volume> dense_values(const WorldBox& box, double voxel, VolumeKind kind) {
  VoxelTransform transform;
  for (std::size_t axis = 0; axis < 3; ++axis) transform.linear[axis][axis] = voxel;
  transform.voxel_size = voxel;
  transform.translation = {box.min.x - 0.3, box.min.y - 0.2, box.min.z - 0.1};
  VolumeBuilder builder(kind, 0, transform);
  const auto bricks = [&](double min, double max) {
    return static_cast<std::int32_t>((max - min) / voxel / kBrickEdge) + 1;
  };
  std::array<float, kBrickCells> values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::sin(static_cast<float>(i));
  }
  for (std::int32_t x = 0; x < bricks(box.min.x, box.max.x); ++x) {
    for (std::int32_t y = 0; y < bricks(box.min.y, box.max.y); ++y) {
      for (std::int32_t z = 0; z < bricks(box.min.z, box.max.z); ++z) {
        builder.add_brick({x, y, z}, values);
      }
    }
  }
  return std::make_shared<const Volume>(std::move(builder).build().value());
}

std::vector<VertexField> fields_of(const FieldKind& kind, const WorldBox& box) {
  std::vector<VertexField> fields;
  for (std::size_t i = 0; i < kind.fields; ++i) {
    VertexField field{"field" + std::to_string(i)};
    for (std::size_t c = 0; c < kind.components; ++c) {
      field.components.push_back(
          dense_values(box, kind.voxel,
                       kind.components == 3 ? VolumeKind::kVectorField : VolumeKind::kField));
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

using Plan = std::shared_ptr<const MeshPlan>;

Plan plan_of(const std::shared_ptr<const Volume>& solid, const FieldKind& kind) {
  MeshRequest request;
  const Plan bare = plan_mesh({.shape = solid, .request = request}).value();
  request.fields = fields_of(kind, bare->header().bounds);
  return plan_mesh({.shape = solid, .request = request}).value();
}

void count(benchmark::State& state, const MeshHeader& header) {
  const auto rate = benchmark::Counter::kIsIterationInvariantRate;
  state.counters["vertices/s"] = {static_cast<double>(header.vertex_count), rate};
  state.counters["tets/s"] = {static_cast<double>(header.tet_count), rate};
}

void fill(benchmark::State& state, const Plan& plan) {
  TetMesh mesh;
  for (auto _ : state) mesh = fill_mesh(*plan, {}, nullptr, std::move(mesh)).value().mesh;
  count(state, plan->header());
}

void sample(benchmark::State& state, const Plan& plan) {
  TetMesh mesh = fill_mesh(*plan, {}, nullptr).value().mesh;
  for (auto _ : state) as_bricks(*plan)->add_fields(mesh);
  count(state, plan->header());
}

using Body = void (*)(benchmark::State& state, const Plan& plan);

void add(
    const char* what, Solid solid, const BenchSize& size, const FieldKind& kind, Body body) {
  const std::string name = std::string(what) + "/" + name_of(solid) + "/" + size.label + "/" +
                           kind.label + "/threads:1";
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    TaskPool pool(1);
    pool.run([&] { body(state, plan_of(make_solid(solid, size), kind)); });
  });
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kMedium}) {
    for (const Solid solid : {Solid::kBall, Solid::kGyroid}) {
      for (const FieldKind& kind : kKinds) {
        add("fill", solid, size, kind, fill);
        if (kind.fields > 0) add("sample", solid, size, kind, sample);
      }
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
