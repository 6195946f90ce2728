// The one diagonal that the longer-column rule leaves open: on the surface quad of `++--`.
#pragma once

#include <span>

#include "core/base/types.h"

namespace tet {

/// Whether the diagonal b-d of the surface quad a, b, c, d gives better tets than a-c: each of
/// `apexes` spans two tets with either diagonal, and the worst dihedral angle among them all,
/// measured by its distance from 0 and 180 degrees, decides; equal ones keep a-c.
bool second_diagonal_is_better(std::span<const WorldPoint> apexes,
                               const WorldPoint& a,
                               const WorldPoint& b,
                               const WorldPoint& c,
                               const WorldPoint& d) noexcept;

}  // namespace tet
