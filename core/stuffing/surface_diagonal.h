// The one diagonal that the longer-column rule leaves open: on the surface quad of `++--`.
#pragma once

#include "core/base/types.h"

namespace tet {

/// Whether the diagonal b-d of the surface quad a, b, c, d gives better tets with `apex` than
/// a-c: the worst dihedral angle of either pair, measured by its distance from 0 and 180
/// degrees, decides; equal ones keep a-c. No neighbour shares the quad, so nobody else needs to
/// agree.
bool second_diagonal_is_better(const WorldPoint& apex,
                               const WorldPoint& a,
                               const WorldPoint& b,
                               const WorldPoint& c,
                               const WorldPoint& d) noexcept;

}  // namespace tet
