// From an OpenVDB grid in memory to a Volume.
#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <openvdb/openvdb.h>

#include "core/grid/volume.h"

namespace tet {

/// Ok when a grid of this type and transform can be meshed; looks at no values.
/// Errors: kFailedPrecondition (says why and what to do).
absl::Status check_meshable(const openvdb::GridBase& grid);

/// Copies a float or double grid, leaf by leaf in parallel.
///
/// Level sets and fog volumes say which they are. Any other grid class is taken for a fog
/// volume when neither its background nor any of its values is negative, and for a level set
/// otherwise. Errors: those of `check_meshable` and `index_volume`, and kFailedPrecondition for
/// an empty grid.
absl::StatusOr<Volume> copy_grid(const openvdb::GridBase& grid);

}  // namespace tet
