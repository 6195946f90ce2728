// Surfaces as the world has them: walls and gaps of any width, of any size, at any place, and
// spoilt in some way.
#pragma once

#include <cstdint>
#include <string>

#include "core/surface/triangle_surface.h"

namespace tet::test {

struct RandomSurface {
  TriangleSurface surface;
  double voxel_size = 0;
  double volume = 0;  ///< of what it stands for
  double area = 0;
  std::string what;  ///< for messages
};

/// Equal for equal seeds. Walls and gaps are 0.5 to 8 voxels wide, sizes 1e-9 to 1e9 and
/// places up to 1e9 sizes away.
RandomSurface random_surface(std::uint64_t seed);

}  // namespace tet::test
