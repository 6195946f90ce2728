// Statistics of tets: dihedral angles and volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/degree_histogram.h"
#include "core/base/extreme_angles.h"
#include "core/base/local_point.h"
#include "core/base/tet_batch.h"
#include "core/base/types.h"

namespace tet {

/// Statistics of the tets of a chunk or of a whole mesh.
///
/// Sums are added in chunk order, so a mesh has one value whatever the number of threads.
struct QualityStats {
  static constexpr int kBins = 180;

  double min_dihedral_deg = 180;
  double max_dihedral_deg = 0;
  double volume = 0;  ///< world units cubed
  /// Dihedral angles (six a tet) by whole degrees: bin d counts [d, d+1).
  std::array<std::uint64_t, kBins> histogram{};

  /// True when nothing was measured.
  bool empty() const noexcept { return min_dihedral_deg > max_dihedral_deg; }

  void add(const QualityStats& other) noexcept;
  /// Adds `count` tets of one shape, whose own statistics are `shape`, each `scale` times its
  /// volume.
  void add_copies(const QualityStats& shape, std::uint64_t count, double scale) noexcept;
};

/// Whether tets are measured as they are made.
enum class Statistics : std::uint8_t { kMeasured, kSkipped };

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
