// From a scene's nodes to a program.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/scene/check_nodes.h"
#include "core/scene/instruction.h"
#include "core/scene/scene_nodes.h"

namespace tet::scene {

/// The program of a checked description: transforms are laid into the frames of the primitives
/// below them, and repetitions are written out. Error: kInvalidArgument (more than
/// Scene::kMaxInstructions).
absl::StatusOr<std::vector<Instruction>> compile(const Description& description,
                                                 const Parts& parts);

}  // namespace tet::scene
