// Dihedral angles as sign(cos) * cos^2: no square root, no arc cosine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/tet_geometry.h"
#include "core/base/types.h"

namespace tet {

/// sign(cos) * cos^2, which falls from 1 to -1 as the angle grows from 0 to 180 degrees.
double signed_square_of_cosine(double degrees) noexcept;
double degrees_of(double signed_square) noexcept;

/// The extreme dihedral angles of some tets, as signed squares of their cosines. Empty at
/// first.
struct AngleRange {
  double largest_cosine = -1;  ///< of the smallest angle
  double smallest_cosine = 1;  ///< of the largest angle

  bool empty() const noexcept { return smallest_cosine > largest_cosine; }
  void add(double cosine) noexcept {
    largest_cosine = std::max(largest_cosine, cosine);
    smallest_cosine = std::min(smallest_cosine, cosine);
  }
  void add(const AngleRange& other) noexcept {
    largest_cosine = std::max(largest_cosine, other.largest_cosine);
    smallest_cosine = std::min(smallest_cosine, other.smallest_cosine);
  }
};

/// Signed squares of the six cosines; -1 at a face without area.
inline std::array<double, 6> dihedral_cosines(const std::array<Vector, 4>& normal) noexcept {
  std::array<double, 4> per_square;
  for (std::size_t i = 0; i < 4; ++i) per_square[i] = 1 / dot(normal[i], normal[i]);
  std::array<double, 6> cosines;
  std::size_t next = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double inward = -dot(normal[i], normal[j]);
      const double cosine = (inward * per_square[i]) * (std::abs(inward) * per_square[j]);
      cosines[next++] = cosine > -1 ? std::min(cosine, 1.0) : -1;  // not a number becomes -1
    }
  }
  return cosines;
}

}  // namespace tet
