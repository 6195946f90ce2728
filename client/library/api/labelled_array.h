// Segmentations of labels in an array.
#pragma once

#include <absl/status/statusor.h>

#include "core/volume/label_volume.h"
#include "tetstream/labels.h"

namespace tetstream {

/// Errors: those of Labels::from_voxels.
absl::StatusOr<tet::LabelVolume> labels_of_array(const LabelArray& labels);

}  // namespace tetstream
