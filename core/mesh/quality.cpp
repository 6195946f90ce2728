#include "core/mesh/quality.h"

#include <algorithm>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/load_batch.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

QualityStats measure_range(const MeshView& view,
                           std::uint64_t begin,
                           std::uint64_t end) noexcept {
  QualityMeter meter;
  TetBatch batch;
  BatchAngles angles;
  for (std::uint64_t i = begin; i < end; i += TetBatch::kSize) {
    const std::size_t count = std::min<std::uint64_t>(TetBatch::kSize, end - i);
    load_batch(view, i, count, batch);
    measure_batch(batch, angles);
    meter.add_batch(angles, count,
                    [&](std::size_t lane) { return view.stored_places(i + lane); });
  }
  return meter.stats();
}

}  // namespace

QualityStats measure_tets(const MeshView& view) noexcept {
  return measure_range(view, 0, view.tet_count());
}

QualityStats measure_quality(const TetMesh& mesh) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<QualityStats> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    ranges[r] = measure_range(mesh.view(), begin, std::min(begin + kTetsPerRange, tets));
  });
  QualityStats total;
  for (const QualityStats& range : ranges) total.add(range);
  return total;
}

}  // namespace tet
