// Segmentations out: as images that any reader of NRRD knows.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/volume/label_volume.h"

namespace tet {

/// Writes an uncompressed NRRD file of the smallest type that has all labels, whole or not at
/// all. Reading it gives the same labels at the same places, bit for bit, where the image's
/// lowest voxel is (0, 0, 0). Errors: those of AtomicFile.
absl::Status write_labels(const LabelVolume& labels, const std::string& path);

}  // namespace tet
