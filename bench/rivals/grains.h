// The image that all contenders mesh: grains in a ball.
#pragma once

#include <cstdint>
#include <vector>

namespace tet::rivals {

/// A label for each voxel of a cube, x fastest, then y, then z; 0 is outside. Voxels are cubes
/// of edge 1, the first one's centre is the origin.
struct LabelCube {
  std::int32_t edge = 0;
  std::vector<std::uint8_t> label;
};

/// Voronoi cells of `labels` random points, labels from 1 on, in a ball that leaves a margin.
LabelCube make_grains(std::int32_t edge, int labels);

}  // namespace tet::rivals
