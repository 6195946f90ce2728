// The field that is meshed: phi, negative inside, sampled on the lattice.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/grid/volume.h"
#include "core/grid/volume_reader.h"

namespace tet {

/// A volume seen at an iso value and a lattice spacing: phi = sign * (value - iso).
///
/// Lattice corner (i, j, k) lies at voxel `spacing_voxels` * (i, j, k); with spacing 1 corners
/// sit on voxel centres and their samples are the stored values.
struct PhiField {
  const Volume* volume = nullptr;
  float iso = 0;
  double spacing_voxels = 1;

  /// Larger values are cut to this, so that sums of eight stay finite.
  static constexpr float kMaxPhi = 1e37F;

  bool at_voxels() const noexcept { return spacing_voxels == 1; }
  bool negated() const noexcept { return volume->kind == VolumeKind::kFogVolume; }
  float phi(float value) const noexcept;

  /// world = linear * lattice + translation, lattice in units of the spacing.
  VoxelTransform lattice_transform() const noexcept;
};

/// Samples of a brick of finest cells and its halo, as columns by `halo_index`.
///
/// Corner (x, y, z) is the cell's lowest; centre (x, y, z) is the cell's own. Valid for corners
/// in
/// [-2, 10]^3 and centres in [-2, 9]^3, the rest is unspecified.
struct BrickSamples {
  alignas(64) std::array<float, kHaloNodes> corner;
  alignas(64) std::array<float, kHaloNodes> centre;
};

/// Samples phi. Not thread-safe: one per task.
class PhiSampler {
 public:
  explicit PhiSampler(const PhiField& field) : field_(field), reader_(*field.volume) {}

  const PhiField& field() const noexcept { return field_; }

  /// Fills `samples` for the lattice brick at `brick`.
  void sample(BrickCoord brick, BrickSamples& samples) noexcept;

  /// True when phi < 0 at a lattice corner.
  bool inside(std::int64_t x, std::int64_t y, std::int64_t z) noexcept;

  /// Trilinear phi at a lattice point (units of the spacing).
  float at(double x, double y, double z) noexcept;

 private:
  void gather_values(BrickCoord brick, BrickSamples& samples) noexcept;
  void interpolate(BrickCoord brick, BrickSamples& samples) noexcept;

  PhiField field_;
  VolumeReader reader_;
};

}  // namespace tet
