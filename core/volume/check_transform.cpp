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

/// Whether the columns are at right angles and have this square, up to a part of it.
bool are_cubes(const Matrix& m, double edge_squared, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double own = column_dot(m, i, i), across = column_dot(m, i, (i + 1) % 3);
    if (!(std::abs(own - edge_squared) <= tolerance * edge_squared)) return false;
    if (!(std::abs(across) <= tolerance * edge_squared)) return false;
  }
  return true;
}

/// Longer voxels than this, or flatter ones, are mistakes: a slice is no thousand times as
/// thick as its pixels are wide.
constexpr double kMostStretch = 1000, kLeastFlatness = 1e-3;

double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

absl::Status check_shape(const VoxelTransform& transform) {
  constexpr const char* kRemedy = "check what wrote it, or resample it";
  const auto edges = voxel_edges(transform);
  const auto [shortest, longest] = std::minmax({edges[0], edges[1], edges[2]});
  if (!(longest <= kMostStretch * shortest)) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "its voxels are %g x %g x %g world units, and the longest edge may be %g times the "
        "shortest: %s",
        edges[0], edges[1], edges[2], kMostStretch, kRemedy));
  }
  // The edges are made unit ones, so that no product of small ones vanishes.
  Matrix unit = transform.linear;
  for (auto& row : unit) {
    for (std::size_t i = 0; i < 3; ++i) row[i] /= edges[i];
  }
  const double flatness = std::abs(determinant(unit));
  if (flatness >= kLeastFlatness) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "its voxels are sheared flat: their volume is %g times that of their edges' box, and at "
      "least %g can be meshed: %s",
      flatness, kLeastFlatness, kRemedy));
}

}  // namespace

std::array<double, 3> voxel_edges(const VoxelTransform& transform) noexcept {
  const Matrix& m = transform.linear;
  return {std::sqrt(column_dot(m, 0, 0)), std::sqrt(column_dot(m, 1, 1)),
          std::sqrt(column_dot(m, 2, 2))};
}

bool are_square(const VoxelTransform& transform) noexcept {
  const Matrix& m = transform.linear;
  const auto edges = voxel_edges(transform);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (!(std::abs(column_dot(m, i, j)) <= kTolerance * edges[i] * edges[j])) return false;
  }
  return true;
}

bool has_cubic_voxels(const VoxelTransform& transform) noexcept {
  const Matrix& m = transform.linear;
  return are_cubes(m, mean_edge_squared(m), kTolerance);
}

bool is_scaled_rotation(const VoxelTransform& transform) noexcept {
  // A turned matrix is off by a few units of 1e-16; and voxel 2^29 by this is by 1e-3 voxels.
  constexpr double kRounding = 1e-12;
  return are_cubes(transform.linear, transform.voxel_size * transform.voxel_size, kRounding);
}

double voxel_edge(const VoxelTransform& transform) noexcept {
  if (has_cubic_voxels(transform)) return std::sqrt(mean_edge_squared(transform.linear));
  const auto edges = voxel_edges(transform);
  return std::min({edges[0], edges[1], edges[2]});
}

absl::Status check_edge(std::string_view what, double length) {
  if (may_be_edge(length)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s %g is not from %g to %g: use another unit of length", what, length,
                      kShortestEdge, kLongestEdge));
}

absl::Status check_transform(const VoxelTransform& transform) {
  const auto& at = transform.translation;
  const auto edges = voxel_edges(transform);
  const bool usable =
      std::all_of(at.begin(), at.end(), [](double x) { return std::isfinite(x); }) &&
      std::all_of(edges.begin(), edges.end(), may_be_edge);
  if (!usable) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "its transform is not usable: voxels of %g x %g x %g, of which no edge may be shorter "
        "than %g or longer than %g, translation (%g, %g, %g): use another unit of length",
        edges[0], edges[1], edges[2], kShortestEdge, kLongestEdge, at[0], at[1], at[2]));
  }
  if (absl::Status s = check_shape(transform); !s.ok()) return s;
  const double edge = voxel_edge(transform);
  if (std::abs(transform.voxel_size - edge) <= kTolerance * edge) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("its voxel size is %g, but its transform makes voxels of %g world units",
                      transform.voxel_size, edge));
}

}  // namespace tet
