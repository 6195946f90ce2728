// What a caller says has been replaced, as bricks of voxels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "tetstream/stable_session.h"
#include "tetstream/volume.h"

namespace tetstream {

/// Boxes of samples beyond which a volume is said to be the one before it; nullopt where
/// nothing is said.
using ReplacedBoxes = std::optional<std::span<const SampleBox>>;

/// The bricks that the boxes touch, sorted; nullopt where nothing is said, or where the volumes
/// are to be compared all the same: they are laid out differently, or the boxes have more
/// bricks than both volumes. Errors: kInvalidArgument (a box that ends before it begins, or
/// lies beyond all that can be meshed; what check_replaced finds to differ elsewhere).
absl::StatusOr<std::optional<std::vector<tet::BrickCoord>>> replaced_bricks(
    const Volume& before, const Volume& after, const ReplacedBoxes& boxes);

}  // namespace tetstream
