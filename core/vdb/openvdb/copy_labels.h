// Grids of whole numbers as segmentations.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "core/volume/label_volume.h"

namespace tet {

/// Whether its values are whole numbers, and its voxels have a volume. Errors:
/// kFailedPrecondition (says what to do).
absl::Status check_labels(const openvdb::GridBase& grid);

/// The values of all voxels of the box around a grid's active ones, whether or not these are
/// active: 0 or 1 of a bool or a mask. Errors: those of check_labels; kFailedPrecondition (no
/// active voxel, more labels than a segmentation has), kResourceExhausted (a box too large).
absl::StatusOr<LabelVolume> copy_labels(const openvdb::GridBase& grid);

}  // namespace tet
