// The smallest and the largest dihedral angle of many tets, found in float and known in double.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/dihedral.h"
#include "core/base/tet_batch.h"
#include "core/base/tet_geometry.h"
#include "core/base/types.h"

namespace tet {

/// Extreme angles of tets that were measured in batches.
///
/// A tet that passes all before it is measured again in double, which is rare. So the angles
/// are a tet's own to the last bits, and another tet may be beyond them by what float cannot
/// tell: 1e-4 degrees, or 0.02 within a degree of 0 and of 180. Depends on the tets and their
/// order alone.
class ExtremeAngles {
 public:
  /// Adds the first `count` tets of a batch; `places_of(lane)` is an array of their corners.
  template <class PlacesOf>
  void add(const BatchAngles& batch, std::size_t count, PlacesOf places_of) noexcept {
    if (!any_beyond(batch)) return;
    for (std::size_t lane = 0; lane < count; ++lane) {
      const float largest = batch.largest_cosine[lane], smallest = batch.smallest_cosine[lane];
      if (largest <= largest_ && smallest >= smallest_) continue;
      largest_ = std::max(largest_, largest);
      smallest_ = std::min(smallest_, smallest);
      const auto& [a, b, c, d] = places_of(lane);
      for (const double cosine : dihedral_cosines(face_normals(a, b, c, d))) range_.add(cosine);
    }
  }

  const AngleRange& range() const noexcept { return range_; }

 private:
  bool any_beyond(const BatchAngles& batch) const noexcept {
    int beyond = 0;
    for (std::size_t lane = 0; lane < TetBatch::kSize; ++lane) {
      beyond |= static_cast<int>(batch.largest_cosine[lane] > largest_) |
                static_cast<int>(batch.smallest_cosine[lane] < smallest_);
    }
    return beyond != 0;
  }

  AngleRange range_;
  float largest_ = -1, smallest_ = 1;  // of tets in batches
};

}  // namespace tet
