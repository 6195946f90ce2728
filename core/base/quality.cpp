#include "core/base/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;

/// sign(cos) * cos^2 falls from 1 to -1 as the angle grows from 0 to 180 degrees.
double signed_square_of_cosine(double degrees) {
  const double cosine = degrees == 90 ? 0 : std::cos(degrees / kDegPerRad);
  return cosine * std::abs(cosine);
}

double degrees_of(double signed_square) noexcept {
  return std::acos(std::copysign(std::sqrt(std::abs(signed_square)), signed_square)) *
         kDegPerRad;
}

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
  std::array<double, 4> per_square;
  for (std::size_t i = 0; i < 4; ++i) per_square[i] = 1 / dot(normal[i], normal[i]);

  six_volumes_ += dot(from_to(a, b), normal[1]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double inward = -dot(normal[i], normal[j]);
      double cosine = (inward * per_square[i]) * (std::abs(inward) * per_square[j]);
      cosine = cosine > -1 ? std::min(cosine, 1.0) : -1;  // not a number becomes -1
      largest_cosine_ = std::max(largest_cosine_, cosine);
      smallest_cosine_ = std::min(smallest_cosine_, cosine);
      ++histogram_[kBinOf(cosine)];
    }
  }
}

QualityStats QualityMeter::stats() const noexcept {
  QualityStats stats;
  stats.histogram = histogram_;
  stats.volume = six_volumes_ / 6;
  if (smallest_cosine_ > largest_cosine_) return stats;  // no tet yet
  stats.min_dihedral_deg = degrees_of(largest_cosine_);
  stats.max_dihedral_deg = degrees_of(smallest_cosine_);
  return stats;
}

}  // namespace tet
