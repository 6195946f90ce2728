#include "core/volume/check_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <absl/strings/str_format.h>

namespace tet {
namespace {

/// How far the voxel's edges may be from equal and square, relative to their length squared:
/// float32 matrices of other programs are off by 1e-6, and angles by no more than this bends.
constexpr double kTolerance = 1e-4;

using Matrix = std::array<std::array<double, 3>, 3>;

/// Dot product of the columns i and j: of two edges of a voxel.
double column_dot(const Matrix& m, std::size_t i, std::size_t j) {
  return m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
}

/// Where all three are equal this is their very number, which (x + x + x) / 3 need not be: a
/// grid that was written with voxels of 0.06 is read with voxels of 0.06.
double mean_edge_squared(const Matrix& m) {
  const double first = column_dot(m, 0, 0);
  return first + ((column_dot(m, 1, 1) - first) + (column_dot(m, 2, 2) - first)) / 3;
}

absl::Status check_edges(const Matrix& m, double edge_squared) {
  constexpr const char* kRemedy =
      "resample the grid onto cubic voxels (OpenVDB's tools::resampleToMatch)";
  const std::array<double, 3> edges{std::sqrt(column_dot(m, 0, 0)),
                                    std::sqrt(column_dot(m, 1, 1)),
                                    std::sqrt(column_dot(m, 2, 2))};
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(edges[i] * edges[i] - edge_squared) > kTolerance * edge_squared) {
      return absl::FailedPreconditionError(
          absl::StrFormat("its voxels are %g x %g x %g world units, which is not uniform: %s",
                          edges[0], edges[1], edges[2], kRemedy));
    }
    for (std::size_t j = i + 1; j < 3; ++j) {
      if (std::abs(column_dot(m, i, j)) > kTolerance * edge_squared) {
        return absl::FailedPreconditionError(absl::StrFormat(
            "its voxels are sheared (edges %d and %d meet at %.4g degrees): %s", i, j,
            std::acos(column_dot(m, i, j) / (edges[i] * edges[j])) * 180 / M_PI, kRemedy));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

double voxel_edge(const VoxelTransform& transform) noexcept {
  return std::sqrt(mean_edge_squared(transform.linear));
}

absl::Status check_transform(const VoxelTransform& transform) {
  const double edge_squared = mean_edge_squared(transform.linear);
  const auto& at = transform.translation;
  const bool finite =
      std::all_of(at.begin(), at.end(), [](double x) { return std::isfinite(x); });
  if (!finite || !std::isnormal(edge_squared)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("its transform is not usable: voxel size %g, translation (%g, %g, %g)",
                        std::sqrt(edge_squared), at[0], at[1], at[2]));
  }
  if (absl::Status s = check_edges(transform.linear, edge_squared); !s.ok()) return s;
  const double edge = std::sqrt(edge_squared);
  if (std::abs(transform.voxel_size - edge) <= kTolerance * edge) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("its voxel size is %g, but its transform makes voxels of %g world units",
                      transform.voxel_size, edge));
}

}  // namespace tet
