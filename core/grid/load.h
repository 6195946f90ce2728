// OpenVDB files in, volumes out. OpenVDB's exceptions stop here and in surface_to_volume.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/grid/volume.h"

namespace tet {

/// What a file says of one of its grids, its values apart.
struct GridInfo {
  std::string name;        ///< "name[0]", "name[1]", ... where several grids share one
  std::string value_type;  ///< "float", "vec3s", "points", ...
  std::string grid_class;  ///< "level set", "fog volume", "unknown", ...
  double voxel_size = 0;   ///< world units; of the x axis where voxels are not uniform
  std::uint64_t active_voxels = 0;
  VoxelBox active_box;
  float background = 0;      ///< 0 for grids that are not float or double
  std::string not_meshable;  ///< why the mesher refuses it; empty when it does not
};

/// What reading a file may take, checked before anything is built of it.
struct LoadLimits {
  std::uint64_t max_bytes = std::uint64_t{16} << 30;  ///< of memory, while it is read
  /// The caller has walked this very file (core/grid/walk_vdb.h) and checked what it takes
  /// (core/grid/memory_charge.h), in this process or in another: both are left out.
  bool walked = false;
};

/// The grids of a `.vdb` file, in the file's order. Values are not read.
/// Errors: kNotFound (no such file), kPermissionDenied, kInvalidArgument (not a VDB file,
/// truncated, corrupt), kResourceExhausted (over `limits`).
absl::StatusOr<std::vector<GridInfo>> list_grids(const std::string& path,
                                                 const LoadLimits& limits = {});

/// Reads one float or double grid. An empty `grid_name` takes the only meshable grid of the
/// file.
///
/// A grid class says level set or fog volume; a grid of another class is a fog volume when
/// neither its background nor any of its values is negative, and a level set otherwise. Errors:
/// kNotFound (file or grid name; the message lists what there is), kPermissionDenied,
/// kInvalidArgument (corrupt file), kFailedPrecondition (a grid that cannot be meshed, or
/// several that can and no name: says why and what to do), kResourceExhausted (over `limits`).
absl::StatusOr<Volume> load_volume(const std::string& path,
                                   const std::string& grid_name,
                                   const LoadLimits& limits = {});

}  // namespace tet
