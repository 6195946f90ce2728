// Whether a scene's grids know the distances that it asks for.
#pragma once

#include <span>
#include <vector>

#include <absl/status/status.h>

#include "core/scene/grid_source.h"
#include "core/scene/instruction.h"
#include "core/scene/scene_nodes.h"

namespace tet::scene {

/// Error: kInvalidArgument (a grid that is not loaded, with its field).
absl::Status check_loaded(const Description& description);

/// Beyond a grid's narrow band every distance is the same, so that an offset, a shell or a
/// blend that reaches so far would take all of space for near. Error: kInvalidArgument (a
/// grid's field: its values end before what the scene asks for, or nothing of it is inside).
absl::Status check_grid_levels(const Description& description,
                               const std::vector<Instruction>& program,
                               std::span<const GridSource> grids);

}  // namespace tet::scene
