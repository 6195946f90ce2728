#include "core/mesh/quality.h"

#include <algorithm>
#include <vector>

#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr std::size_t kTetsPerRange = 16384;

QualityStats measure_range(const TetMesh& mesh, std::uint64_t begin, std::uint64_t end) {
  QualityMeter meter;
  for (std::uint64_t i = begin; i < end; ++i) {
    const auto [a, b, c, d] = mesh.tet(i);
    meter.add_tet(mesh.stored_position(a), mesh.stored_position(b), mesh.stored_position(c),
                  mesh.stored_position(d));
  }
  return meter.stats();
}

}  // namespace

QualityStats measure_quality(const TetMesh& mesh) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<QualityStats> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    ranges[r] = measure_range(mesh, begin, std::min(begin + kTetsPerRange, tets));
  });
  QualityStats total;
  for (const QualityStats& range : ranges) total.add(range);
  return total;
}

}  // namespace tet
