// Values of a volume on a lattice that does not sit on its voxels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// Up to 16 lattice points along an axis, between which voxels they lie, and how far.
class AxisPoints {
 public:
  static constexpr std::size_t kMax = 16;

  /// Points at voxel `spacing_voxels` * (first + i): a function of their own coordinates, so
  /// that every brick finds the same of them.
  AxisPoints(double first, std::size_t count, double spacing_voxels) noexcept;

  std::size_t count() const noexcept { return count_; }
  /// The voxels that are needed, increasing; a point lies between two that follow each other.
  std::size_t voxels() const noexcept { return voxels_; }
  std::int32_t voxel(std::size_t i) const noexcept { return voxel_[i]; }
  /// The voxel before a point, as one of those.
  std::size_t before(std::size_t point) const noexcept { return before_[point]; }
  /// How far a point lies from the voxel before it, in [0, 1].
  float weight(std::size_t point) const noexcept { return weight_[point]; }

 private:
  std::size_t count_, voxels_ = 0;
  std::array<std::int32_t, 2 * kMax> voxel_;
  std::array<std::size_t, kMax> before_{};
  std::array<float, kMax> weight_{};
};

/// Trilinear values at all points of the lattice x * y * z, into the rows of a halo column.
///
/// Interpolates along x, then y, then z, in float: within 3 rounding errors of the largest
/// value around a point, and never beyond the range of the eight.
void interpolate_lattice(VolumeReader& reader,
                         const AxisPoints& x,
                         const AxisPoints& y,
                         const AxisPoints& z,
                         std::array<float, kHaloNodes>& values) noexcept;

/// The value that it finds at one lattice point, to the bit: at voxel `spacing_voxels` * (x, y,
/// z).
float interpolate_at(VolumeReader& reader,
                     const std::array<double, 3>& point,
                     double spacing_voxels) noexcept;

}  // namespace tet
