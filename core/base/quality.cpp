#include "core/base/quality.h"

#include <algorithm>

#include "core/base/vector_clones.h"

namespace tet {

void QualityStats::add(const QualityStats& other) noexcept {
  min_dihedral_deg = std::min(min_dihedral_deg, other.min_dihedral_deg);
  max_dihedral_deg = std::max(max_dihedral_deg, other.max_dihedral_deg);
  volume += other.volume;
  for (std::size_t d = 0; d < histogram.size(); ++d) histogram[d] += other.histogram[d];
}

void QualityStats::add_copies(const QualityStats& shape,
                              std::uint64_t count,
                              double scale) noexcept {
  if (count == 0) return;
  min_dihedral_deg = std::min(min_dihedral_deg, shape.min_dihedral_deg);
  max_dihedral_deg = std::max(max_dihedral_deg, shape.max_dihedral_deg);
  volume += static_cast<double>(count) * scale * shape.volume;
  for (std::size_t d = 0; d < histogram.size(); ++d) histogram[d] += count * shape.histogram[d];
}

[[gnu::always_inline]] inline void QualityMeter::add_lanes(
    const LocalPoint* points,
    std::span<const LocalTet, TetBatch::kSize> tets,
    std::size_t count) noexcept {
  TetBatch batch;
  BatchAngles angles;
  batch.load([&](std::size_t lane) {
    const auto& [a, b, c, d] = tets[lane];
    const FloatRow from = row_of(points[a]);
    return std::array{row_of(points[b]) - from, row_of(points[c]) - from,
                      row_of(points[d]) - from};
  });
  measure_batch(batch, angles);
  add_batch(angles, count, [&](std::size_t lane) {
    const auto place = [&](std::uint16_t i) {
      return WorldPoint{points[i].x, points[i].y, points[i].z};
    };
    const auto& [a, b, c, d] = tets[lane];
    return std::array{place(a), place(b), place(c), place(d)};
  });
}

TET_VECTOR_CLONES
void QualityMeter::add_tets(const LocalPoint* points, std::span<const LocalTet> tets) noexcept {
  constexpr std::size_t kSize = TetBatch::kSize;
  for (; tets.size() >= kSize; tets = tets.subspan(kSize)) {
    add_lanes(points, tets.first<kSize>(), kSize);
  }
  if (tets.empty()) return;
  std::array<LocalTet, kSize> last;
  std::fill(std::copy(tets.begin(), tets.end(), last.begin()), last.end(), tets.back());
  add_lanes(points, last, tets.size());
}

TET_VECTOR_CLONES
void QualityMeter::count_batch(const BatchAngles& batch, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    six_volumes_[i] += static_cast<double>(batch.six_volumes[i]);
  }
  histogram_.add(batch.cosine, count);
}

QualityStats QualityMeter::stats() const noexcept {
  QualityStats stats;
  stats.histogram = histogram_.counts();
  for (const double six_volumes : six_volumes_) stats.volume += six_volumes / 6;
  const AngleRange& angles = extremes_.range();
  if (angles.empty()) return stats;
  stats.min_dihedral_deg = degrees_of(angles.largest_cosine);
  stats.max_dihedral_deg = degrees_of(angles.smallest_cosine);
  return stats;
}

}  // namespace tet
