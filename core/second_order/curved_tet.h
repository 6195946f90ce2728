// The Jacobian of a tet with ten nodes, everywhere in it.
#pragma once

#include <array>

#include "core/base/types.h"
#include "core/base/vec3.h"

namespace tet {

/// Corners, and then the middles of edges in the order of kTetEdges.
using TenNodes = std::array<WorldPoint, 10>;

/// The Jacobian's determinant is a cubic of the place in the tet. These are its coefficients in
/// Bernstein's basis, whose functions are nowhere negative and add up to one: the determinant
/// is nowhere below the least of them, nor above the largest. Of a straight tet all are six
/// times its volume.
using JacobianCoefficients = std::array<double, 20>;

JacobianCoefficients jacobian_coefficients(const TenNodes& node) noexcept;

/// Less than or equal to the least determinant anywhere in the tet.
double least_jacobian(const TenNodes& node) noexcept;

/// The volume, exactly: the mean of the coefficients over six.
double volume_of(const TenNodes& node) noexcept;

/// The determinant at a place given by the shares of the corners.
double jacobian_at(const TenNodes& node, const std::array<double, 4>& shares) noexcept;

}  // namespace tet
