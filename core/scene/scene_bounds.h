// Bounds of phi in cubes, through the same operators as phi itself: but for negations none of
// them falls where a part of it rises.
#pragma once

#include <cstddef>

#include "core/scene/instruction.h"

namespace tet::scene {

/// Columns of what phi is not below, and not above.
struct PhiBounds {
  Values low, high;
};

/// Widens a primitive's values at the middle of cubes to bounds within the cubes.
void bound_primitive(double half_edge, std::size_t count, PhiBounds& bounds) noexcept;

void bound_unary(const Instruction& op, std::size_t count, PhiBounds& bounds) noexcept;
void bound_binary(const Instruction& op,
                  std::size_t count,
                  PhiBounds& left,
                  const PhiBounds& right) noexcept;

}  // namespace tet::scene
