#include "bench/rivals/tetstream.h"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>

#include "bench/peak_memory.h"
#include "core/base/parallel.h"
#include "core/plan/labelled/label_request.h"
#include "core/plan/make/fill_mesh.h"
#include "core/volume/label_volume.h"

namespace tet::rivals {
namespace {

template <class T>
T value_of(absl::StatusOr<T> result) {
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.status().ToString().c_str());
    std::exit(1);
  }
  return *std::move(result);
}

TetMesh mesh_of(const LabelCube& cube, double spacing) {
  const std::vector<std::int64_t> values(cube.label.begin(), cube.label.end());
  LabelImage image;
  image.size = {cube.edge, cube.edge, cube.edge};
  image.values = values;
  PlanJob job;
  job.shape = std::make_shared<const LabelVolume>(value_of(make_label_volume(image)));
  job.request.spacing = spacing;
  job.request.labels.emplace();
  job.request.levels = 0;
  const auto plan = value_of(plan_label_image(job, Cancellation()));
  return value_of(fill_mesh(*plan, Cancellation(), nullptr)).mesh;
}

}  // namespace

PlainMesh mesh_with_tetstream(const LabelCube& cube, double spacing) {
  const WorkerThreads threads;
  TaskPool pool(1);
  PlainMesh out;
  pool.run([&] {
    const bench::PeakMemory peak;
    const double start = cpu_seconds();
    const TetMesh mesh = mesh_of(cube, spacing);
    out.cpu_seconds = cpu_seconds() - start;
    out.peak_bytes = peak.peak_bytes();
    for (std::uint64_t v = 0; v < mesh.header.vertex_count; ++v) {
      const WorldPoint at = mesh.vertex(v);
      out.vertex.push_back({at.x, at.y, at.z});
    }
    for (std::uint64_t t = 0; t < mesh.header.tet_count; ++t) {
      const auto [a, b, c, d] = mesh.tet(t);
      out.tet.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                         static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(d)});
      out.label.push_back(static_cast<std::uint8_t>(mesh.label(t)));
    }
  });
  return out;
}

}  // namespace tet::rivals
