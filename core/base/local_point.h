// Positions near one brick, in float: small enough for a brick's tets to stay in the cache.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "core/base/float_row.h"

namespace tet {

/// Position in spacings from a brick's lowest corner; with its padding, one vector register.
struct alignas(16) LocalPoint {
  float x, y, z;
};

inline FloatRow row_of(const LocalPoint& point) noexcept {
  FloatRow row;
  std::memcpy(&row, &point, sizeof(row));
  return row;
}

/// A tet's corners in its own order, as indices of a brick's points.
using LocalTet = std::array<std::uint16_t, 4>;

}  // namespace tet
