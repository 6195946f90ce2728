// From a scene's nodes to a program.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <absl/status/status.h>

#include "core/scene/check_nodes.h"
#include "core/scene/instruction.h"
#include "core/scene/scene_nodes.h"

namespace tet::scene {

struct Program {
  std::vector<Instruction> instructions;
  std::vector<NodeRun> runs;  ///< every node's, each as often as it was written out
  std::vector<std::shared_ptr<const Volume>> grids;  ///< each once, by their numbers
};

/// Error: kInvalidArgument (more than Scene::kMaxInstructions, every copy counted).
absl::Status check_instructions(const Description& description, const Parts& parts);

/// Transforms multiply, and so do what they scale by: where a node's own coordinates leave the
/// range of a double, none of its values means anything. Error: kInvalidArgument.
absl::Status check_frames(const Description& description,
                          const std::vector<Instruction>& program);

/// Columns that the evaluation of a program needs at most.
std::size_t deepest_stack(const std::vector<Instruction>& program);

/// The program of a checked description: transforms are laid into the frames of the leaves
/// below them, and repetitions are written out. Its grids are loaded.
Program compile(const Description& description, const Parts& parts);

}  // namespace tet::scene
