// Measures tets: their dihedral angles and their volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/degree_histogram.h"
#include "core/base/extreme_angles.h"
#include "core/base/local_point.h"
#include "core/base/quality_stats.h"
#include "core/base/tet_batch.h"
#include "core/base/types.h"

namespace tet {

/// Gathers the statistics of tets.
class QualityMeter {
 public:
  /// Adds tets whose corners are `points`, several at once. The volume is in units of the
  /// points; it and the histogram are computed in float, a tet's volume to about 1e-7 of the
  /// cube of its edges. An inverted tet has a negative volume and the same angles; an angle at
  /// a face without area counts as 180 degrees.
  ///
  /// A meter takes 2^29 tets. What it says depends on the calls and their order alone.
  void add_tets(const LocalPoint* points, std::span<const LocalTet> tets) noexcept;

  /// Adds the first `count` tets of a measured batch; `places_of(lane)` is their four corners.
  template <class PlacesOf>
  void add_batch(const BatchAngles& batch, std::size_t count, PlacesOf places_of) noexcept {
    extremes_.add(batch, count, places_of);
    count_batch(batch, count);
  }

  QualityStats stats() const noexcept;

 private:
  void add_lanes(const LocalPoint* points,
                 std::span<const LocalTet, TetBatch::kSize> tets,
                 std::size_t count) noexcept;
  void count_batch(const BatchAngles& batch, std::size_t count) noexcept;

  DegreeHistogram histogram_;
  ExtremeAngles extremes_;
  TetBatch::Column<double> six_volumes_{};  // of every sixteenth tet
};

}  // namespace tet
