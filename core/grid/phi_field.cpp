#include "core/grid/phi_field.h"

#include <algorithm>
#include <cstddef>

namespace tet {
namespace {

constexpr int kMinNode = -2, kMaxCorner = 10, kMaxCentre = 9;

/// A centre's sample is the mean of its cell's corners, summed along z, then y, then x.
void average_centres(BrickSamples& samples) noexcept {
  alignas(64) std::array<float, kHaloNodes> sum;
  constexpr auto kDx = static_cast<std::size_t>(offset_index(1, 0, 0));
  constexpr auto kDy = static_cast<std::size_t>(offset_index(0, 1, 0));
  const auto& corner = samples.corner;
  for (std::size_t i = 0; i + 1 < kHaloNodes; ++i) sum[i] = corner[i] + corner[i + 1];
  sum[kHaloNodes - 1] = 0;
  for (std::size_t i = 0; i + kDy < kHaloNodes; ++i) sum[i] += sum[i + kDy];
  for (std::size_t i = 0; i + kDx < kHaloNodes; ++i) {
    samples.centre[i] = 0.125F * (sum[i] + sum[i + kDx]);
  }
}

/// Copies row (x, y), z in [-2, 10], from the three bricks that it passes through.
void gather_row(const VolumeReader::Brick* along_z, int row_in_brick, float* row) noexcept {
  const auto copy = [&](const VolumeReader::Brick& brick, int first, int count, float* out) {
    if (brick.values == nullptr) {
      std::fill_n(out, count, brick.range.min);
    } else {
      std::copy_n(brick.values + row_in_brick * 8 + first, count, out);
    }
  };
  copy(along_z[0], 6, 2, row);
  copy(along_z[1], 0, 8, row + 2);
  copy(along_z[2], 0, 3, row + 10);
  std::fill_n(row + 13, 3, row[12]);
}

}  // namespace

float PhiField::phi(float value) const noexcept {
  const float shifted = negated() ? iso - value : value - iso;
  return std::clamp(shifted, -kMaxPhi, kMaxPhi);
}

VoxelTransform PhiField::lattice_transform() const noexcept {
  VoxelTransform transform = volume->transform;
  for (auto& row : transform.linear) {
    for (double& entry : row) entry *= spacing_voxels;
  }
  transform.voxel_size *= spacing_voxels;
  return transform;
}

void PhiSampler::sample(BrickCoord brick, BrickSamples& samples) noexcept {
  if (field_.at_voxels()) {
    gather_values(brick, samples);
  } else {
    interpolate(brick, samples);
  }
}

void PhiSampler::gather_values(BrickCoord brick, BrickSamples& samples) noexcept {
  std::array<VolumeReader::Brick, 27> bricks;
  std::size_t next = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        bricks[next++] = reader_.brick({brick.x + x, brick.y + y, brick.z + z});
      }
    }
  }
  for (int x = kMinNode; x <= kMaxCorner; ++x) {
    for (int y = kMinNode; y <= kMaxCorner; ++y) {
      const int bx = (x >> 3) + 1, by = (y >> 3) + 1;
      gather_row(&bricks[static_cast<std::size_t>((bx * 3 + by) * 3)], (x & 7) * 8 + (y & 7),
                 &samples.corner[static_cast<std::size_t>(halo_index(x, y, kMinNode))]);
    }
    // Rows past the last are never used, but the sums read them: keep them finite.
    std::fill_n(&samples.corner[static_cast<std::size_t>(halo_index(x, 11, -2))], 3 * 16, 0.0F);
  }
  std::fill(samples.corner.begin() + halo_index(11, -2, -2), samples.corner.end(), 0.0F);
  for (float& value : samples.corner) value = field_.phi(value);
  average_centres(samples);
}

void PhiSampler::interpolate(BrickCoord brick, BrickSamples& samples) noexcept {
  const auto fill = [&](const HaloSet& nodes, double shift, auto& column) {
    column.fill(0);
    for_each_bit(nodes, [&](int index) {
      column[static_cast<std::size_t>(index)] =
          at(8.0 * brick.x + (index >> 8) - 2 + shift,
             8.0 * brick.y + (index >> 4 & 15) - 2 + shift,
             8.0 * brick.z + (index & 15) - 2 + shift);
    });
  };
  constexpr HaloSet kCorners = halo_cube(kMinNode, kMaxCorner);
  constexpr HaloSet kCentres = halo_cube(kMinNode, kMaxCentre);
  fill(kCorners, 0, samples.corner);
  fill(kCentres, 0.5, samples.centre);
}

bool PhiSampler::inside(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
  if (field_.at_voxels()) {
    const VoxelCoord voxel{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                           static_cast<std::int32_t>(z)};
    return field_.phi(reader_.value(voxel)) < 0;
  }
  return at(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) < 0;
}

float PhiSampler::at(double x, double y, double z) noexcept {
  const double s = field_.spacing_voxels;
  return field_.phi(static_cast<float>(reader_.trilinear({s * x, s * y, s * z})));
}

}  // namespace tet
