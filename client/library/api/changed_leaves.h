// What has changed from one volume to another, as a session's frames have it.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/volume/volume.h"
#include "tetstream/v1/meshes.pb.h"

namespace tetstream {

/// The leaves that turn `before` into `after`. Both have the same kind, transform and
/// background. Takes time in proportion to both volumes, unless `among`, which may be null, has
/// all bricks that can differ. Errors: kInvalidArgument (they differ in what a frame cannot
/// change), kCancelled, kDeadlineExceeded.
absl::StatusOr<std::vector<v1::LeafUpdate>> changed_leaves(
    const tet::Volume& before,
    const tet::Volume& after,
    const tet::Cancellation& cancellation,
    const std::vector<tet::BrickCoord>* among = nullptr);

}  // namespace tetstream
