// Boxes of bricks.
#pragma once

#include <cstdint>

#include "core/base/types.h"

namespace tet {

/// A box of finest-level bricks, both ends included.
struct BrickBox {
  BrickCoord min, max;
};

inline double bricks_in(const BrickBox& box) noexcept {
  return (box.max.x - box.min.x + 1.0) * (box.max.y - box.min.y + 1.0) *
         (box.max.z - box.min.z + 1.0);
}

/// Calls `visit(brick)` for each brick of a box.
template <class Visit>
void for_each_brick(const BrickBox& box, const Visit& visit) {
  for (std::int32_t x = box.min.x; x <= box.max.x; ++x) {
    for (std::int32_t y = box.min.y; y <= box.max.y; ++y) {
      for (std::int32_t z = box.min.z; z <= box.max.z; ++z) visit(BrickCoord{x, y, z});
    }
  }
}

}  // namespace tet
