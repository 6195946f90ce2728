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
/// A tet that may pass all before it is measured again in double, which is rare. So they are
/// exactly those that double arithmetic finds, once they are beyond the background's own: those
/// are too many to look at again, and another of them may be up to 1e-4 degrees beyond.
class ExtremeAngles {
 public:
  /// Adds the first `count` tets of a batch; `places_of(lane)` is an array of their corners.
  template <class PlacesOf>
  void add(const BatchAngles& batch, std::size_t count, PlacesOf places_of) noexcept {
    if (!any_beyond(batch)) return;
    for (std::size_t lane = 0; lane < count; ++lane) {
      const float largest = batch.largest_cosine[lane], smallest = batch.smallest_cosine[lane];
      if (largest <= largest_bar() && smallest >= smallest_bar()) continue;
      largest_ = std::max(largest_, largest);
      smallest_ = std::min(smallest_, smallest);
      const auto& [a, b, c, d] = places_of(lane);
      for (const double cosine : dihedral_cosines(face_normals(a, b, c, d))) range_.add(cosine);
    }
  }

  const AngleRange& range() const noexcept { return range_; }

 private:
  /// Twice what float arithmetic is off by, in tets of the mesher's.
  static constexpr float kRounding = 4e-6F;
  /// Between the angles of the background, 45 to 120 degrees, and the others.
  static constexpr float kLargestOfBackground = 0.51F, kSmallestOfBackground = -0.26F;

  /// What a tet must be above to be looked at again; and below.
  float largest_bar() const noexcept {
    return largest_ > kLargestOfBackground ? largest_ - kRounding : largest_;
  }
  float smallest_bar() const noexcept {
    return smallest_ < kSmallestOfBackground ? smallest_ + kRounding : smallest_;
  }

  bool any_beyond(const BatchAngles& batch) const noexcept {
    const float largest = largest_bar(), smallest = smallest_bar();
    int beyond = 0;
    for (std::size_t lane = 0; lane < TetBatch::kSize; ++lane) {
      beyond |= static_cast<int>(batch.largest_cosine[lane] > largest) |
                static_cast<int>(batch.smallest_cosine[lane] < smallest);
    }
    return beyond != 0;
  }

  AngleRange range_;
  float largest_ = -1, smallest_ = 1;  // of tets in batches
};

}  // namespace tet
