// How far a scene reaches.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/scene/grid_source.h"
#include "core/scene/instruction.h"

namespace tet::scene {

/// A box around all points where the program's phi is below 0, to within rounding errors;
/// infinite along axes where there is no end, and empty (min > max) where there are no such
/// points for certain.
///
/// Grows with offsets and blends as they do, part by part, so that it holds them whatever
/// phi's quality as a distance.
WorldBox extent_of(const std::vector<Instruction>& program, std::span<const GridSource> grids);

/// The node of the first leaf that has no end by itself; there is one where the extent is
/// infinite.
std::size_t endless_node(const std::vector<Instruction>& program,
                         std::span<const GridSource> grids);

}  // namespace tet::scene
