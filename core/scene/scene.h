// A solid made of primitives and operators: one continuous function of space, negative inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/scene/grid_source.h"
#include "core/scene/instruction.h"
#include "core/scene/scene_nodes.h"

namespace tet {

/// A scene ready to be evaluated. Immutable once made, so any number of threads may read it.
///
/// phi changes by at most the distance between two points, in world units, but for what comes
/// of grids: those lie between the values of the voxels around. From either follow bounds for a
/// neighbourhood (SceneEvaluator::bounds).
struct Scene {
  /// Instructions in postfix order: the last one's value is phi.
  std::vector<scene::Instruction> program;
  std::vector<scene::GridSource> grids;  ///< by the numbers in instructions
  std::vector<std::string> node_names;   ///< of the description, by their numbers
  std::vector<scene::NodeRun> runs;      ///< of instructions that each node was written out as
  /// What the last node, a union, is made of, in its order; of any other the node itself.
  std::vector<scene::NodeRun> solids;
  std::string blended;          ///< the field that blends them, where one does
  std::size_t stack_depth = 0;  ///< columns that evaluation needs at most
  /// Holds all that is inside, to within rounding errors; infinite where the scene has no end,
  /// empty (min > max) where nothing can be inside.
  WorldBox extent;
  std::string inside_guess;  ///< as MeshHeader::inside_guess: a line for each grid
  std::string endless;       ///< the node that has no end, where the extent is infinite

  bool ends() const noexcept { return endless.empty(); }

  static constexpr std::size_t kMaxNodes = 1024;
  static constexpr std::size_t kMaxNameBytes = 64;
  static constexpr int kMaxDepth = 64;  ///< nodes on the way from the last one to a primitive
  /// Primitives and operators, every copy counted.
  static constexpr std::size_t kMaxInstructions = 4096;
  static constexpr std::size_t kMaxGrids = 16;  ///< different ones
};

/// What can be wrong with a scene before its grids are loaded. Error: that of make_scene.
absl::Status check_scene(const scene::Description& description);

/// Compiles a description whose grids are loaded. Errors: kInvalidArgument; the message begins
/// with the field that is wrong, as `nodes[3].torus.minor_radius`, and says its value and what
/// it may be.
absl::StatusOr<Scene> make_scene(const scene::Description& description);

/// OK where the scene has an end. Error: kInvalidArgument, as those of make_scene.
absl::Status check_ends(const Scene& scene);

}  // namespace tet
