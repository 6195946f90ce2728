// A trilinear function of the unit cube, as voxels make one between eight of them.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/vec3.h"

namespace tet {

/// A value and how fast it grows along each axis.
struct ValueSlope {
  double value = 0;
  Vector slope{};
};

struct TrilinearCell {
  std::array<double, 8> corner;  ///< at x*4 + y*2 + z

  ValueSlope at(double x, double y, double z) const noexcept {
    const auto along_z = [&](std::size_t i) {
      return corner[i] + z * (corner[i + 1] - corner[i]);
    };
    const auto z_slope = [&](std::size_t i) { return corner[i + 1] - corner[i]; };
    const auto mix = [](double low, double high, double t) { return low + t * (high - low); };
    const double v00 = along_z(0), v01 = along_z(2), v10 = along_z(4), v11 = along_z(6);
    const double v0 = mix(v00, v01, y), v1 = mix(v10, v11, y);
    return {mix(v0, v1, x),
            {v1 - v0, mix(v01 - v00, v11 - v10, x),
             mix(mix(z_slope(0), z_slope(2), y), mix(z_slope(4), z_slope(6), y), x)}};
  }
};

}  // namespace tet
