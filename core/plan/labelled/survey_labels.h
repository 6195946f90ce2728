// The first pass: every brick of a box of labels, looked at once.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/labels/labelled_brick.h"
#include "core/octree/cell_set.h"
#include "core/plan/labelled/label_states.h"
#include "core/plan/mesh_progress.h"

namespace tet {

/// The bricks of the domain, and those beyond its upper faces, whose corners lie on them.
struct LabelSurvey {
  LabelRules rules;
  LabelStates state;
  std::vector<BrickCoord> at;  ///< sorted: bricks where labels meet
  std::vector<std::unique_ptr<const LabelledBrick>> brick;
  std::uint64_t bytes = 0;

  /// The label of a corner that no tet cuts or moves.
  Label corner_label(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept;
  /// Cells that must be finest.
  CellSet finest() const;
};

/// Parallel. Errors: kResourceExhausted (more than `most_bytes`), kCancelled,
/// kDeadlineExceeded.
absl::StatusOr<LabelSurvey> survey_labels(const LabelSource& source,
                                          const LabelRules& rules,
                                          std::uint64_t most_bytes,
                                          const Cancellation& cancellation,
                                          MeshProgress* progress);

}  // namespace tet
