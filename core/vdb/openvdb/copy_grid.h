// From an OpenVDB grid in memory to a Volume.
#pragma once

#include <cstdint>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "core/volume/volume.h"

namespace tet {

/// Ok when a grid of this type and transform can be meshed; looks at no values.
/// Errors: kFailedPrecondition (says why and what to do).
absl::Status check_meshable(const openvdb::GridBase& grid);

/// Copies a grid of numbers, leaf by leaf in parallel; of bools and masks 1 and 0.
///
/// Level sets and fog volumes say which they are. Any other grid class is taken for a fog
/// volume when neither its background nor any of its values is negative, and for a level set
/// otherwise. Errors: those of `check_meshable` and `index_volume`, and kFailedPrecondition for
/// an empty grid.
absl::StatusOr<Volume> copy_grid(const openvdb::GridBase& grid);

/// Whether its numbers, or those of its vectors, are float or double.
bool has_real_values(const openvdb::GridBase& grid);

/// Ok when the values of a grid of this type and transform can be looked up.
/// Errors: kFailedPrecondition (says why and what to do).
absl::Status check_field(const openvdb::GridBase& grid);

/// Values that a grid has in each voxel: 1 or 3; 0 where `check_field` fails.
std::uint32_t field_components(const openvdb::GridBase& grid);

/// Copies one component of a grid as `copy_grid` copies it; the values of inactive voxels, too.
/// It may be empty: then all of it is background. Errors: those of `check_field` and
/// `index_volume`; kInvalidArgument (no such component).
absl::StatusOr<Volume> copy_field(const openvdb::GridBase& grid, std::uint32_t component);

}  // namespace tet
