// Which bricks of the lattice can hold a piece of the surface, and which lie inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/brick_box.h"
#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"

namespace tet {

struct FoundBricks {
  /// Sorted, unique. Every brick in whose halo phi changes sign (or is zero) is among them.
  std::vector<BrickCoord> near_surface;
  /// Boxes that cover every finest cell with an inside corner, those near the surface included;
  /// they may overlap.
  std::vector<BrickBox> inside;
  /// Finest cells in bricks with inside voxels: more than there are inside cells, by less than
  /// one layer of bricks.
  double inside_cells = 0;
};

/// A brick near the surface costs about 2 KiB until the mesh is made.
inline constexpr std::size_t kMaxSurfaceBricks = std::size_t{1} << 23;

/// Finds the bricks of a volume. It looks at value ranges only, brick by brick, and reads no
/// samples. Parallel. Errors: kResourceExhausted (more than `most_bricks` near the surface),
/// kFailedPrecondition (more space than can be looked at), kCancelled, kDeadlineExceeded.
absl::StatusOr<FoundBricks> find_bricks(const PhiField& field,
                                        std::size_t most_bricks = kMaxSurfaceBricks,
                                        const Cancellation& cancellation = {});

/// OK, or kResourceExhausted where so many bricks near the surface are too many to keep.
absl::Status check_surface_bricks(double bricks, std::size_t most);

/// OK where the inside has an end: the background is outside, and no part of a scene goes on
/// for ever. Errors: kFailedPrecondition (of a volume), those of check_ends (of a scene).
absl::Status check_inside_ends(const PhiField& field);

/// Leaves only what a mesh of both sides of `domain` needs: bricks near the surface in it and
/// just beyond its upper faces, whose corners lie on them; all of the domain counts as covered.
void keep_domain(const BrickBox& domain, FoundBricks& found);

/// Leaves only what a mesh of the inside needs that ends at a box.
void keep_inside_of(const BrickBox& box, const PhiField& field, FoundBricks& found);

}  // namespace tet
