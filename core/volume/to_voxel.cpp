#include "core/volume/to_voxel.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "core/volume/check_transform.h"

namespace tet {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix transposed(const Matrix& m) noexcept {
  Matrix out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) out[row][column] = m[column][row];
  }
  return out;
}

/// By its cofactors.
Matrix inverted(const Matrix& m) noexcept {
  const auto cofactor = [&](std::size_t row, std::size_t column) {
    const std::size_t r1 = (row + 1) % 3, r2 = (row + 2) % 3;
    const std::size_t c1 = (column + 1) % 3, c2 = (column + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double det =
      m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  Matrix out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      out[row][column] = cofactor(column, row) / det;
    }
  }
  return out;
}

}  // namespace

InverseLinear::InverseLinear(const VoxelTransform& transform) noexcept {
  if (is_scaled_rotation(transform)) {
    row = transposed(transform.linear);
    divisor = transform.voxel_size * transform.voxel_size;
  } else {
    row = inverted(transform.linear);
  }
}

Matrix InverseLinear::matrix() const noexcept {
  Matrix out = row;
  for (auto& of_axis : out) {
    for (double& entry : of_axis) entry /= divisor;
  }
  return out;
}

VoxelPoint ToVoxel::operator()(const WorldPoint& p) const noexcept {
  const std::array<double, 3> from{p.x - translation_[0], p.y - translation_[1],
                                   p.z - translation_[2]};
  std::array<double, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) {
      at[axis] += inverse_.row[axis][row] * from[row];
    }
    at[axis] /= inverse_.divisor;
  }
  return {at[0], at[1], at[2]};
}

VoxelSpan to_voxel_span(const VoxelTransform& transform, const WorldBox& box) noexcept {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const ToVoxel to_voxel(transform);
  VoxelSpan span{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
  for (int corner = 0; corner < 8; ++corner) {
    const auto [x, y, z] = to_voxel({(corner & 1) != 0 ? box.max.x : box.min.x,
                                     (corner & 2) != 0 ? box.max.y : box.min.y,
                                     (corner & 4) != 0 ? box.max.z : box.min.z});
    span.min = {std::min(span.min.x, x), std::min(span.min.y, y), std::min(span.min.z, z)};
    span.max = {std::max(span.max.x, x), std::max(span.max.y, y), std::max(span.max.z, z)};
  }
  return span;
}

}  // namespace tet
