// The one diagonal that the longer-column rule leaves open: on the surface quad of `++--`.
#pragma once

#include <span>

#include "core/base/types.h"

namespace tet {

/// The squared cosine of an angle beyond 90 degrees counts this many times when diagonals are
/// compared. Where all four cut points lie in the middle of short edges either diagonal has an
/// angle of cosine -sqrt(2/3), 144.74 degrees: no rule has a better bound. With 1.5 that angle
/// counts like one of 0 degrees, so a larger one is never taken for the sake of a small one.
inline constexpr double kObtuseWeight = 1.5;

/// Whether the diagonal b-d of the surface quad a, b, c, d gives better tets than a-c: each of
/// `apexes` spans two tets with either diagonal, and the worst dihedral angle among them all
/// decides, by its weighted squared cosine; equal ones keep a-c.
bool second_diagonal_is_better(std::span<const WorldPoint> apexes,
                               const WorldPoint& a,
                               const WorldPoint& b,
                               const WorldPoint& c,
                               const WorldPoint& d) noexcept;

}  // namespace tet
