// Which nodes the warp must leave in their places so that the boundary is a manifold.
#pragma once

#include <memory>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/field/phi_field.h"
#include "core/stuffing/restored_nodes.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

/// Finds them in rounds: all nodes where the boundary is no manifold are restored at once,
/// which may show others. The surface touches itself at zero nodes only, and each round has
/// fewer of them, so the rounds end; they read signs alone, so they end alike for any number of
/// threads. Null where there is nothing to restore. Errors: kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const RestoredNodes>> find_nodes_to_restore(
    const PhiField& field,
    const std::vector<BrickCoord>& candidates,
    const StuffingRules& rules,
    const Cancellation& cancellation);

}  // namespace tet
