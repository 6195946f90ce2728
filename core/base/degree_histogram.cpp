#include "core/base/degree_histogram.h"

#include <algorithm>

#include "core/base/lane_angles.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

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
