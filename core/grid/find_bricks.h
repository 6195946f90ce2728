// Which bricks of the lattice can hold a piece of the surface, and which lie inside.
#pragma once

#include <cstdint>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/grid/phi_field.h"

namespace tet {

/// A cube of finest-level bricks, `edge` bricks wide.
struct BrickCube {
  BrickCoord min;
  std::int32_t edge = 1;
};

struct FoundBricks {
  /// Sorted, unique. Every brick in whose halo phi changes sign (or is zero) is among them.
  std::vector<BrickCoord> near_surface;
  /// Cubes that cover every finest cell with an inside corner, those near the surface included;
  /// they may overlap.
  std::vector<BrickCube> inside;
};

/// Looks at value ranges only, brick by brick; reads no samples. Parallel.
/// Errors: kFailedPrecondition (the inside has no end), kResourceExhausted (more
/// space than can be looked at).
absl::StatusOr<FoundBricks> find_bricks(const PhiField& field);

}  // namespace tet
