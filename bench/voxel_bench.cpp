// What voxels that are no cubes cost: the same ball, at the same spacing, from grids of several
// voxels. One thread, from a volume in memory to a whole mesh.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "core/base/parallel.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/volume/check_transform.h"
#include "core/volume/volume_builder.h"

namespace tet::bench {
namespace {

constexpr double kRadius = 60;

struct VoxelKind {
  const char* label;
  double x, y, z;        ///< edges
  double turn, spacing;  ///< about z; of the lattice
};
constexpr std::array kKinds{
    VoxelKind{"cubes", 1, 1, 1, 0, 1},
    VoxelKind{"cubes_between_voxels", 1, 1, 1, 0, 0.97},
    VoxelKind{"one_percent", 1, 1, 1.01, 0, 1},
    VoxelKind{"slices", 1, 1, 3, 0, 1},
    VoxelKind{"oblique_slices", 1, 1, 3, 0.4, 1},
};

VoxelTransform transform_of(const VoxelKind& kind) {
  VoxelTransform transform;
  const double c = std::cos(kind.turn), s = std::sin(kind.turn);
  transform.linear = {
      {{c * kind.x, -s * kind.y, 0}, {s * kind.x, c * kind.y, 0}, {0, 0, kind.z}}};
  transform.voxel_size = voxel_edge(transform);
  return transform;
}

std::shared_ptr<const Volume> ball_of(const VoxelKind& kind) {
  const VoxelTransform transform = transform_of(kind);
  VolumeBuilder builder(VolumeKind::kLevelSet, 8, transform);
  const auto half = [](double edge) {
    return static_cast<std::int32_t>(std::ceil((kRadius + 8) / edge / kBrickEdge));
  };
  std::array<float, kBrickCells> values;
  for (std::int32_t x = -half(kind.x); x < half(kind.x); ++x) {
    for (std::int32_t y = -half(kind.y); y < half(kind.y); ++y) {
      for (std::int32_t z = -half(kind.z); z < half(kind.z); ++z) {
        for (int i = 0; i < kBrickCells; ++i) {
          const int slice = i / 64;
          const WorldPoint p =
              transform.to_world({8.0 * x + slice, 8.0 * y + i / 8 % 8, 8.0 * z + i % 8});
          values[static_cast<std::size_t>(i)] =
              static_cast<float>(std::min(8.0, std::hypot(p.x, p.y, p.z) - kRadius));
        }
        builder.add_brick({x, y, z}, values);
      }
    }
  }
  return std::make_shared<const Volume>(std::move(builder).build().value());
}

void mesh_ball(benchmark::State& state, const VoxelKind& kind) {
  const std::shared_ptr<const Volume> volume = ball_of(kind);
  MeshRequest request;
  request.spacing = kind.spacing;
  request.levels = 0;
  TetMesh mesh;
  for (auto _ : state) {
    const auto plan = plan_mesh({.shape = volume, .request = request}).value();
    mesh = fill_mesh(*plan, {}, nullptr, std::move(mesh)).value().mesh;
  }
  state.counters["tets/s"] = {static_cast<double>(mesh.header.tet_count),
                              benchmark::Counter::kIsIterationInvariantRate};
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const VoxelKind& kind : kKinds) {
    const std::string name = std::string("mesh/ball/") + kind.label + "/threads:1";
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
      tet::TaskPool pool(1);
      pool.run([&] { mesh_ball(state, kind); });
    });
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
