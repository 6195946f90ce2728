// Which bricks of the lattice can hold a piece of a scene's surface, and which lie inside.
#pragma once

#include <cstddef>
#include <optional>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/field/find_bricks.h"
#include "core/field/phi_field.h"

namespace tet {

/// Finds the bricks of a scene within `domain`, or within all that the scene reaches, from
/// bounds alone: cubes of bricks are looked at 64 parts at a time, coarse ones first, and only
/// those that may hold both signs are looked into. Parallel. Errors: kInvalidArgument (beyond
/// index space), kResourceExhausted (more than `most_bricks` near the surface), kCancelled,
/// kDeadlineExceeded.
absl::StatusOr<FoundBricks> find_scene_bricks(const PhiField& field,
                                              const std::optional<BrickBox>& domain,
                                              std::size_t most_bricks,
                                              const Cancellation& cancellation);

}  // namespace tet
