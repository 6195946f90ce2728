// Sizings by seed, of every kind.
#pragma once

#include <cstdint>

#include "core/base/types.h"
#include "core/octree/sizing.h"

namespace tet::test {

/// A valid sizing for leaves of `spacing` and more in `box`. Equal arguments give equal
/// sizings.
Sizing random_sizing(std::uint32_t seed, const WorldBox& box, double spacing);

}  // namespace tet::test
