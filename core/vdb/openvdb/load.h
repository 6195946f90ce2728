// OpenVDB files and images in, volumes out. OpenVDB's exceptions stop here and in
// surface_to_volume.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/vdb/plain/load_limits.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// What reading a file may take, checked before anything is built of it.
/// The grids of a `.vdb` file, or the arrays of an image, in the file's order. Values are not
/// read. Errors: kNotFound (no such file), kPermissionDenied, kInvalidArgument (not a VDB file,
/// truncated, corrupt), kResourceExhausted (over `limits`).
absl::StatusOr<std::vector<GridInfo>> list_grids(const std::string& path,
                                                 const LoadLimits& limits = {});
absl::StatusOr<std::vector<GridInfo>> list_grids(const OpenGridFile& file,
                                                 const LoadLimits& limits = {});

/// Reads one grid of numbers. An empty `grid_name` takes the only meshable grid of the file, or
/// the only one of float or double; of an image its only array of one number a voxel.
///
/// A grid class says level set or fog volume; what the values of a grid without class mean is
/// guessed: core/volume/inside.h. Errors:
/// kNotFound (file or grid name; the message lists what there is), kPermissionDenied,
/// kInvalidArgument (corrupt file), kFailedPrecondition (a grid that cannot be meshed, or
/// several that can and no name: says why and what to do), kResourceExhausted (over `limits`).
absl::StatusOr<Volume> load_volume(const std::string& path,
                                   const std::string& grid_name,
                                   const LoadLimits& limits = {});
absl::StatusOr<Volume> load_volume(const OpenGridFile& file,
                                   const std::string& grid_name,
                                   const LoadLimits& limits = {});

/// Reads one component of a float, double, vec3s or vec3d grid: values to be looked up. An
/// empty `grid_name` takes the only such grid of the file. The volume's kind is
/// VolumeKind::kVectorField where there are two more components; it may be empty. Errors: those
/// of load_volume, where it is no field; kInvalidArgument (no such component).
absl::StatusOr<Volume> load_field(const std::string& path,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  const LoadLimits& limits = {});
absl::StatusOr<Volume> load_field(const OpenGridFile& file,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  const LoadLimits& limits = {});

/// Reads the labels of an image, or of a grid of int32, int64, bool or mask: 0 and 1. An empty
/// `grid_name` takes the only such array or grid. Errors: those of load_volume;
/// kFailedPrecondition (values that are no labels).
absl::StatusOr<LabelVolume> load_labels(const std::string& path,
                                        const std::string& grid_name,
                                        const LoadLimits& limits = {});
absl::StatusOr<LabelVolume> load_labels(const OpenGridFile& file,
                                        const std::string& grid_name,
                                        const LoadLimits& limits = {});

/// Has OpenVDB do all that it does once in a process, so that no later call does.
void prepare_loading();

}  // namespace tet
