#include "core/mesh/quality.h"

#include <algorithm>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/load_batch.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

QualityStats measure_run(const MeshView& view,
                         std::uint64_t begin,
                         std::uint64_t end,
                         double spacing) noexcept {
  const EdgeScale scale(spacing);
  QualityMeter meter;
  TetBatch batch;
  BatchAngles angles;
  for (std::uint64_t i = begin; i < end; i += TetBatch::kSize) {
    const std::size_t count = std::min<std::uint64_t>(TetBatch::kSize, end - i);
    load_batch(view, i, count, scale, batch);
    measure_batch(batch, angles);
    meter.add_batch(angles, count,
                    [&](std::size_t lane) { return view.stored_places(i + lane); });
  }
  QualityStats stats = meter.stats();
  stats.volume = scale.volume_of(stats.volume);
  return stats;
}

/// The tets of each part are about as large as its own spacing.
QualityStats measure_parts(const TetMesh& mesh,
                           std::uint64_t begin,
                           std::uint64_t end) noexcept {
  const MeshView view = mesh.view();
  if (mesh.header.parts.empty()) return measure_run(view, begin, end, mesh.header.spacing);
  QualityStats stats;
  for (const MeshPart& part : mesh.header.parts) {
    const std::uint64_t first = std::max(begin, part.first_tet),
                        last = std::min(end, part.first_tet + part.tet_count);
    if (first < last) stats.add(measure_run(view, first, last, part.spacing));
  }
  return stats;
}

}  // namespace

QualityStats measure_tets(const MeshView& view, double spacing) noexcept {
  return measure_run(view, 0, view.tet_count(), spacing);
}

QualityStats measure_quality(const TetMesh& mesh) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<QualityStats> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    ranges[r] = measure_parts(mesh, begin, std::min(begin + kTetsPerRange, tets));
  });
  QualityStats total;
  for (const QualityStats& range : ranges) total.add(range);
  return total;
}

}  // namespace tet
