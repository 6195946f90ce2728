// What a file says of one of its grids, its values apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/base/types.h"

namespace tet {

/// Longer names are refused.
inline constexpr std::size_t kMaxGridNameBytes = 1024;

struct GridInfo {
  std::string name;        ///< "name[0]", "name[1]", ... where several grids share one
  std::string value_type;  ///< "float", "vec3s", "points", ...
  std::string grid_class;  ///< "level set", "fog volume", "unknown", ...
  double voxel_size = 0;   ///< world units; the shortest edge where voxels are not cubes
  std::uint64_t active_voxels = 0;
  VoxelBox active_box;
  float background = 0;                ///< 0 for grids that are not float or double
  std::string not_meshable;            ///< why the mesher refuses it; empty when it does not
  std::uint32_t field_components = 0;  ///< 1 or 3 of a grid that can be a field; else 0
  std::string made_of;  ///< what the grid says of the surface that it was converted from
  /// Says of an image its format, voxels and axes, for people; of another grid its voxels,
  /// where they are no cubes; else empty.
  std::string place;
};

}  // namespace tet
