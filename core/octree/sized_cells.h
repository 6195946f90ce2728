// A sizing becomes rules for an octree's leaves.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/field/phi_field.h"
#include "core/octree/leaf_rules.h"
#include "core/octree/sizing.h"

namespace tet {

/// The levels that a sizing leaves of `levels`, for nowhere are leaves longer than so many
/// allow.
int levels_of(const Sizing& sizing, double spacing, int levels) noexcept;

/// Rules for leaves of at most `levels` levels in `cover`, by a sizing that check_sizing took.
/// Errors: kResourceExhausted (a region, named, or the grid takes more than `most_leaves`).
absl::StatusOr<LeafRules> leaf_rules(const Sizing& sizing,
                                     const PhiField& field,
                                     const OctreeCover& cover,
                                     int levels,
                                     double most_leaves,
                                     const Cancellation& cancellation);

}  // namespace tet
