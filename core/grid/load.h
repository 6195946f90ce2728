// OpenVDB files in, volumes out. The only file, with surface_to_volume, that reads through
// OpenVDB; its exceptions stop here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/grid/volume.h"

namespace tet {

/// What a file says of one of its grids, without judging more than the header shows.
struct GridInfo {
  std::string name;
  std::string value_type;  ///< "float", "vec3s", "points", ...
  std::string grid_class;  ///< "level set", "fog volume", "unknown", ...
  double voxel_size = 0;   ///< world units; of the x axis where voxels are not uniform
  std::uint64_t active_voxels = 0;
  VoxelBox active_box;
  float background = 0;      ///< 0 for grids that are not float
  std::string not_meshable;  ///< why the mesher refuses it; empty when it does not
};

/// The grids of a `.vdb` file, in the file's order.
/// Errors: kNotFound (no such file), kInvalidArgument (not a VDB file, truncated, corrupt).
absl::StatusOr<std::vector<GridInfo>> list_grids(const std::string& path);

/// Reads one float grid. An empty `grid_name` takes the only meshable grid of the file.
/// Errors: kNotFound (file or grid name; the message lists what there is), kInvalidArgument
/// (corrupt file), kFailedPrecondition (a grid that cannot be meshed: says why and what to do).
absl::StatusOr<Volume> load_volume(const std::string& path, const std::string& grid_name);

}  // namespace tet
