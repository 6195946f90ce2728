// Statistics of background tets, which are of a few shapes: none of them is measured twice.
#pragma once

#include "core/base/quality_stats.h"
#include "core/lattice/background.h"
#include "core/mesh/lattice_to_world.h"

namespace tet {

/// Gathers the statistics of background tets. They are counted, and only in the end spread over
/// the histogram, as a brick has few of them.
class BackgroundMeter {
 public:
  /// Adds the tets of leaves of a level.
  void add(const BackgroundCounts& counts, int level) noexcept;

  /// The volume is in units of the finest spacing, and added in the order of the calls.
  QualityStats stats() const noexcept;

 private:
  BackgroundCounts counts_;
  double volume_ = 0;
};

/// What a volume in units of the spacing is in the world.
double volume_scale(const LatticeToWorld& to_world) noexcept;

}  // namespace tet
