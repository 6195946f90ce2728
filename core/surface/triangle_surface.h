// Triangles, as surface files hold them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// A triangle surface in world units; vertex ids are within range, coordinates finite.
struct TriangleSurface {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace tet
