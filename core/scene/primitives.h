// The leaves of a scene that are formulas: phi of one primitive at many points.
#pragma once

#include <cstddef>

#include "core/scene/instruction.h"

namespace tet::scene {

/// Fills `values` for the first `count` points with a leaf's phi, negative inside: the distance
/// to its surface, or less (docs/scenes.md says of which). A point's value depends on the point
/// alone, and changes no faster than one per world unit.
void evaluate_primitive(const Instruction& leaf,
                        const Points& points,
                        std::size_t count,
                        Values& values) noexcept;

}  // namespace tet::scene
