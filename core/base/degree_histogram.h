// Counting dihedral angles by whole degrees.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/tet_batch.h"

namespace tet {

/// How many angles lie in [d, d+1) degrees, for d from 0 to 179; 180 counts as 179.
///
/// Angles are computed in float. One less than 4e-4 degrees below a whole degree may be counted
/// as that degree; so angles of 45, 60, 90 and 120 degrees are counted as those. Within 5
/// degrees of 0 and of 180 rounding weighs more, up to 0.02 degrees.
class DegreeHistogram {
 public:
  static constexpr int kBins = 180;

  /// Adds the first `count` tets of a batch by the signed squared cosines of their angles.
  void add(const std::array<TetBatch::Column<float>, 6>& cosines, std::size_t count) noexcept;

  std::array<std::uint64_t, kBins> counts() const noexcept;

 private:
  /// Tets in a row are often alike, and counting into one bin again and again waits for the
  /// last store each time; so neighbours count into different tables.
  static constexpr std::size_t kTables = 8;
  std::array<std::array<std::uint32_t, kBins + 1>, kTables> count_{};
};

}  // namespace tet
