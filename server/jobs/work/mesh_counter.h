// Counts meshes for jobs: whole, or a part of what others add up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <absl/functional/function_ref.h>
#include <absl/status/statusor.h>

#include "server/streams/mesh_engine.h"

namespace tet {

/// What is counted, and who may stop it.
struct CountOrder {
  MeshOrder mesh;
  std::shared_ptr<PlanningWatch> watch;
};

/// On the engine's threads, behind the meshes that somebody waits for; see PlanTurns.
///
/// Thread safety: any thread but the engine's may call any member; each waits until it is done.
class MeshCounter {
 public:
  explicit MeshCounter(MeshEngine& engine) : engine_(engine) {}

  /// Plans that were made lately are at hand. Errors: those of Planner::plan.
  absl::StatusOr<PlannedMesh> count(const CountOrder& order, SurveyedBlocks surveyed);

  /// Blocks of `block_bricks` that the survey is worth dividing into: one, unless there are
  /// more than two. Errors: those of Planner::load and count_survey_blocks.
  absl::StatusOr<std::int64_t> blocks(const CountOrder& order, std::int64_t block_bricks);

  /// Errors: those of Planner::load and survey_block.
  absl::StatusOr<std::vector<std::byte>> survey(const CountOrder& order,
                                                std::int64_t block_bricks,
                                                std::int64_t block);

 private:
  absl::StatusOr<PlanInput> load(const CountOrder& order);
  void run_large(const CountOrder& order, absl::FunctionRef<void()> work);

  MeshEngine& engine_;
};

}  // namespace tet
