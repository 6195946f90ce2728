// What can be wrong with the grids of a scene.
#pragma once

#include <span>
#include <vector>

#include <absl/status/status.h>

#include "core/scene/grid_source.h"
#include "core/scene/instruction.h"
#include "core/scene/scene_nodes.h"

namespace tet::scene {

// What is wrong is kInvalidArgument, and the message begins with the field.

/// Checks that there are at most Scene::kMaxGrids different grids, however often they are used.
absl::Status check_grid_count(const Description& description);

absl::Status check_loaded(const Description& description);

/// Whether it is known of each grid, which is loaded, which side is inside.
absl::Status check_insides(const Description& description);

/// A line for each grid whose inside is guessed: MeshHeader::inside_guess.
std::string guessed_insides(const Description& description);

/// Beyond a grid's narrow band every distance is the same, so that an offset, a shell or a
/// blend that reaches so far would take all of space for near. Refused is what asks for more
/// than the grid's values hold, and a grid without a surface.
absl::Status check_grid_levels(const Description& description,
                               const std::vector<Instruction>& program,
                               std::span<const GridSource> grids);

}  // namespace tet::scene
