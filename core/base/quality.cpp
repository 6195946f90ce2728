#include "core/base/quality.h"

#include <algorithm>

#include "core/base/tet_geometry.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Whole degrees of a signed squared cosine, by a table of first guesses and a step or two.
class DegreeBins {
 public:
  DegreeBins() {
    for (int d = 0; d <= QualityStats::kBins; ++d) {
      lower_edge_[static_cast<std::size_t>(d)] = signed_square_of_cosine(d);
    }
    std::size_t bin = QualityStats::kBins - 1;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      const double upper_end = static_cast<double>(cell + 1) / kCellsPerUnit - 1;
      while (bin > 0 && lower_edge_[bin] < upper_end) --bin;
      first_guess_[cell] = static_cast<std::uint8_t>(bin);
    }
  }

  std::size_t operator()(double signed_square) const noexcept {
    const auto cell = static_cast<std::size_t>((signed_square + 1) * kCellsPerUnit);
    std::size_t bin = first_guess_[cell];
    while (bin + 1 < QualityStats::kBins && signed_square <= lower_edge_[bin + 1]) ++bin;
    return bin;
  }

 private:
  static constexpr double kCellsPerUnit = 2048;
  static constexpr std::size_t kCells = 2 * 2048 + 1;

  std::array<double, QualityStats::kBins + 1> lower_edge_{};
  std::array<std::uint8_t, kCells> first_guess_{};
};

const DegreeBins kBinOf;

}  // namespace

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

void QualityMeter::add_tet(const WorldPoint& a,
                           const WorldPoint& b,
                           const WorldPoint& c,
                           const WorldPoint& d) noexcept {
  const std::array<Vector, 4> normal = face_normals(a, b, c, d);
  six_volumes_[0] += dot(from_to(a, b), normal[1]);
  extremes_.add(normal);
  const std::array<double, 6> cosines = dihedral_cosines(normal);
  for (std::size_t edge = 0; edge < 6; ++edge) {
    histogram_.add_one(kBinOf(cosines[edge]));
  }
}

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

void QualityMeter::add_lanes(const LocalPoint* points,
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
