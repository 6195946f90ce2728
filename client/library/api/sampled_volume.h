// Volumes of samples in an array.
#pragma once

#include <absl/status/statusor.h>

#include "core/volume/volume.h"
#include "tetstream/volume.h"

namespace tetstream {

/// Errors: those of Volume::from_samples.
absl::StatusOr<tet::Volume> volume_of_samples(const SampleArray& samples);

}  // namespace tetstream
