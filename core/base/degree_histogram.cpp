#include "core/base/degree_histogram.h"

#include <algorithm>
#include <cmath>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Degrees of asin(sqrt(t)) for t in [0, 1/2]: sqrt(t) times a polynomial that is off by 1.4e-4
/// degrees at most (found by Remez exchange).
[[gnu::always_inline]] inline float degrees_of_half(float t) noexcept {
  const float low = 57.2978251F + 9.47438572F * t, middle = 5.05318527F - 0.425775705F * t;
  const float square = t * t;
  return std::sqrt(t) * (low + square * (middle + square * 6.30918103F));
}

/// Whole degrees of a dihedral angle from its signed squared cosine.
[[gnu::always_inline]] inline std::int32_t whole_degrees(float cosine) noexcept {
  constexpr float kRounding = 2e-4F;
  const float square = std::abs(cosine);
  const float rest = std::abs(1 - square);
  const float part = degrees_of_half(square < rest ? square : rest);
  const float from_right = square < 0.5F ? part : 90 - part;
  return static_cast<std::int32_t>(90 + kRounding - std::copysign(from_right, cosine));
}

using Column = TetBatch::Column<float>;
using Degrees = TetBatch::Column<std::int32_t>;

TET_VECTOR_CLONES
void find_degrees(const std::array<Column, 6>& __restrict cosine,
                  std::array<Degrees, 6>& __restrict degrees) noexcept {
  for (std::size_t edge = 0; edge < 6; ++edge) {
    for (std::size_t i = 0; i < TetBatch::kSize; ++i)
      degrees[edge][i] = whole_degrees(cosine[edge][i]);
  }
}

}  // namespace

void DegreeHistogram::add(const std::array<Column, 6>& cosines, std::size_t count) noexcept {
  alignas(64) std::array<Degrees, 6> degrees;
  find_degrees(cosines, degrees);
  for (const Degrees& column : degrees) {
    const auto count_one = [&](std::size_t i) {
      ++count_[i % kTables][static_cast<std::size_t>(column[i])];
    };
    if (count == TetBatch::kSize) {
#pragma GCC unroll 32
      for (std::size_t i = 0; i < TetBatch::kSize; ++i) count_one(i);
    } else {
      for (std::size_t i = 0; i < count; ++i) count_one(i);
    }
  }
}

std::array<std::uint64_t, DegreeHistogram::kBins> DegreeHistogram::counts() const noexcept {
  std::array<std::uint64_t, kBins> counts{};
  for (const auto& table : count_) {
    for (std::size_t d = 0; d < kBins; ++d) counts[d] += table[d];
    counts[kBins - 1] += table[kBins];
  }
  return counts;
}

}  // namespace tet
