// What a scene does with the values of its parts, column by column.
#pragma once

#include <cstddef>

#include "core/scene/instruction.h"

namespace tet::scene {

/// Applies a unary operator to the first `count` of `values`.
void apply_unary(const Instruction& op, std::size_t count, Values& values) noexcept;

/// Applies kMin or kMax to the first `count` of two columns; the result is in `left`.
///
/// With a smoothing k the smaller (larger) of two values that are less than k apart is lowered
/// (raised) by (k - |a - b|)^2 / 4k; others come out as they are, bit by bit. Source: the
/// quadratic polynomial of Inigo Quilez, https://iquilezles.org/articles/smin.
void apply_binary(const Instruction& op,
                  std::size_t count,
                  Values& left,
                  const Values& right) noexcept;

}  // namespace tet::scene
