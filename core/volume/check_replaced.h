// Whether a list of replaced leaves can be all that differs between two volumes.
#pragma once

#include <vector>

#include <absl/status/status.h>

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// Whether two volumes are laid out alike, so that check_replaced can look at them: kind,
/// place, background, and the constants far from everything are the same.
bool alike_but_for_leaves(const Volume& a, const Volume& b);

/// Looks for what differs outside of `replaced` (bricks of voxels, sorted): bricks that only
/// one volume has values of, other constants, another least or greatest value of a brick, and
/// any other value of the bricks around those that are replaced. Other values within the same
/// bounds are not noticed further away. Errors: kInvalidArgument (names the first brick that
/// differs).
absl::Status check_replaced(const Volume& before,
                            const Volume& after,
                            const std::vector<BrickCoord>& replaced);

/// Those of `replaced` (sorted) whose values differ, of two volumes that are laid out alike.
/// Takes time in proportion to the named bricks' values, and to the list of all.
std::vector<BrickCoord> changed_among(const Volume& before,
                                      const Volume& after,
                                      const std::vector<BrickCoord>& replaced);

}  // namespace tet
