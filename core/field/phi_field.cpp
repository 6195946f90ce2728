#include "core/field/phi_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/base/vector_clones.h"
#include "core/field/brick_sides.h"
#include "core/field/scene_samples.h"
#include "core/scene/scene_evaluator.h"
#include "core/volume/interpolate_lattice.h"

namespace tet {
namespace {

constexpr int kMaxCorner = 10;
constexpr std::size_t kUsedRows = kMaxCorner - kHaloMin + 1;  // of a slice; as many slices

/// One of kBrickParts, and where its voxels are in the halo.
struct Part : BrickPart {
  std::size_t at;
};
constexpr std::array<Part, 3> kHaloParts{
    {{kBrickParts[0], 0}, {kBrickParts[1], 2}, {kBrickParts[2], 10}}};

/// Returns one of the 27 bricks at and around a brick: `i` is 9*(x+1) + 3*(y+1) + z+1.
BrickCoord brick_around(BrickCoord brick, int i) noexcept {
  return {brick.x + i / 9 - 1, brick.y + i / 3 % 3 - 1, brick.z + i % 3 - 1};
}

/// A brick of values as rows along z; all rows of a constant brick are one.
struct BrickRows {
  const float* first = nullptr;
  std::size_t stride = 0;

  const float* row(std::size_t x, std::size_t y) const noexcept {
    return first + (x * 8 + y) * stride;
  }
};

/// The 27 bricks at and around a brick.
class Surroundings {
 public:
  Surroundings(VolumeReader& reader, BrickCoord brick) noexcept {
    for (int i = 0; i < 27; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const VolumeReader::Brick found = reader.brick(brick_around(brick, i));
      if (found.values != nullptr) {
        rows_[at] = {found.values, 8};
      } else {
        constant_[at].fill(found.range.min);
        rows_[at] = {constant_[at].data(), 0};
      }
    }
  }
  Surroundings(const Surroundings&) = delete;  // it points into itself
  Surroundings& operator=(const Surroundings&) = delete;

  /// Copies all rows of the halo that are used, brick by brick.
  void copy_rows(std::array<float, kHaloNodes>& values) const noexcept {
    const BrickRows* along_z = rows_.data();
    for (const Part& x : kHaloParts) {
      for (const Part& y : kHaloParts) {
        copy_rows_along_z(along_z, x, y, &values[x.at * kHaloSlice + y.at * kHaloRow]);
        along_z += 3;
      }
    }
  }

 private:
  static void copy_rows_along_z(const BrickRows* along_z,
                                const Part& x,
                                const Part& y,
                                float* to) noexcept {
    const BrickRows before = along_z[0], here = along_z[1], behind = along_z[2];
    for (std::size_t i = 0; i < x.count; ++i) {
      const float* low = before.row(x.first + i, y.first) + 6;
      const float* middle = here.row(x.first + i, y.first);
      const float* high = behind.row(x.first + i, y.first);
      float* row = to + i * kHaloSlice;
      for (std::size_t j = 0; j < y.count; ++j, row += kHaloRow) {
        std::memcpy(row, low, 2 * sizeof(float));
        std::memcpy(row + 2, middle, 8 * sizeof(float));
        std::memcpy(row + 10, high, 6 * sizeof(float));
        low += before.stride;
        middle += here.stride;
        high += behind.stride;
      }
    }
  }

  std::array<BrickRows, 27> rows_;
  std::array<std::array<float, 8>, 27> constant_;
};

/// Makes phi of values, in as many slices as rows.
TET_VECTOR_CLONES
void shift_slices(std::size_t rows,
                  const PhiField& field,
                  std::array<float, kHaloNodes>& column) noexcept {
  const float sign = field.negated() ? -1.0F : 1.0F, shift = -sign * field.iso;
  for (std::size_t x = 0; x < rows; ++x) {
    float* const slice = &column[x * kHaloSlice];
    for (std::size_t i = 0; i < rows * kHaloRow; ++i) {
      slice[i] = PhiField::clamped(sign * slice[i] + shift);
    }
  }
}

/// A centre's sample is the mean of its cell's corners, summed along z, then y, then x.
TET_VECTOR_CLONES
void average_centres(BrickSamples& samples) noexcept {
  constexpr std::size_t kUsed = (kUsedRows - 1) * kHaloRow;
  alignas(64) std::array<float, kUsed> sums{};  // of the slice before
  for (std::size_t x = 0; x < kUsedRows; ++x) {
    float* const corner = &samples.corner[x * kHaloSlice];
    corner[kUsedRows * kHaloRow] = 0;  // the last row's sums along z read it
    // What the first slice leaves behind itself is no centre, and is written again.
    float* const before = &samples.centre[(x == 0 ? 0 : x - 1) * kHaloSlice];
    for (std::size_t i = 0; i < kUsed; ++i) {
      const float sum =
          (corner[i] + corner[i + 1]) + (corner[i + kHaloRow] + corner[i + kHaloRow + 1]);
      before[i] = 0.125F * (sums[i] + sum) + 0.0F;  // no zero has a sign
      sums[i] = sum;
    }
  }
}

}  // namespace

float PhiField::phi(float value) const noexcept {
  return clamped(negated() ? iso - value : value - iso);
}

VoxelTransform PhiField::lattice_transform() const noexcept {
  VoxelTransform transform = voxel_transform();
  for (auto& row : transform.linear) {
    for (double& entry : row) entry *= spacing_voxels;
  }
  transform.voxel_size *= spacing_voxels;
  return transform;
}

PhiSampler::PhiSampler(const PhiField& field) : field_(field) {
  if (field.scene == nullptr) {
    reader_.emplace(*field.volume);
    if (!field.at_voxels()) block_ = std::make_unique<VoxelBlock>();
  } else {
    scene_ = std::make_unique<SceneEvaluator>(*field.scene);
  }
}

PhiSampler::~PhiSampler() = default;
PhiSampler::PhiSampler(PhiSampler&&) noexcept = default;
PhiSampler& PhiSampler::operator=(PhiSampler&&) noexcept = default;

void PhiSampler::stop_when(const Cancellation& cancellation) noexcept {
  if (scene_ != nullptr) scene_->stop_when(cancellation);
}

void PhiSampler::remember_in(BrickSides& sides) noexcept { sides_ = &sides; }

void PhiSampler::sample(BrickCoord brick, BrickSamples& samples) noexcept {
  if (scene_ != nullptr) {
    sample_scene(*scene_, field_.spacing_voxels, brick, samples);
  } else if (field_.at_voxels()) {
    gather_values(brick, samples);
  } else {
    interpolate(brick, samples);
  }
}

// Centres are means of corners, so on one side with them.
bool PhiSampler::one_sided(BrickCoord brick) noexcept {
  if (!field_.at_voxels()) return false;
  const InsideTestOfValue inside(field_);
  Sides sides;
  const auto add = [&](std::size_t i) {
    const VolumeReader::Brick found = reader_->brick(brick_around(brick, static_cast<int>(i)));
    const bool min = inside(found.range.min), max = inside(found.range.max);
    sides.add(min == max ? Sides{min, !min} : sides_of_part(found.values, i));
  };
  add(kAllOfBrick);  // itself: nearly all that are at the surface have both sides there
  for (std::size_t i = 0; i < 27 && !sides.both(); ++i) add(i);
  return !sides.both();
}

/// Tells of a brick whose values, by its range, lie on both sides.
Sides PhiSampler::sides_of_part(const float* values, std::size_t part) noexcept {
  if (part == kAllOfBrick) return {true, true};
  if (sides_ == nullptr) {
    return BrickSides::part_of(find_sides(InsideTestOfValue(field_), values), part);
  }
  const auto value = static_cast<std::size_t>(values - field_.volume->values.data());
  return sides_->of_part(value / kBrickCells, part);
}

void PhiSampler::gather_values(BrickCoord brick, BrickSamples& samples) noexcept {
  Surroundings(*reader_, brick).copy_rows(samples.corner);
  shift_slices(kUsedRows, field_, samples.corner);
  average_centres(samples);
}

void PhiSampler::interpolate(BrickCoord brick, BrickSamples& samples) noexcept {
  const auto fill = [&](double first, std::size_t count, auto& column) {
    const auto points = [&](std::int32_t at) {
      return AxisPoints(8.0 * at + first, count, field_.spacing_voxels);
    };
    interpolate_lattice(*reader_, points(brick.x), points(brick.y), points(brick.z), column);
    shift_slices(count, field_, column);
  };
  fill(kHaloMin, kUsedRows, samples.corner);
  fill(kHaloMin + 0.5, kUsedRows - 1, samples.centre);
}

/// Whether the block has the voxels around the points of a brick and its halo.
bool PhiSampler::copy_around(BrickCoord brick) noexcept {
  const auto voxel = [&](std::int32_t at, int node) {
    return static_cast<std::int32_t>(std::floor(field_.spacing_voxels * (8.0 * at + node)));
  };
  const VoxelBox box{
      {voxel(brick.x, kHaloMin), voxel(brick.y, kHaloMin), voxel(brick.z, kHaloMin)},
      {voxel(brick.x, kMaxCorner) + 1, voxel(brick.y, kMaxCorner) + 1,
       voxel(brick.z, kMaxCorner) + 1}};
  if (block_ == nullptr || voxels_in(box) > VoxelBlock::kMaxVoxels) return false;
  if (block_->box.min != box.min || block_->box.max != box.max) block_->copy(*reader_, box);
  return true;
}

void PhiSampler::sample_points(BrickCoord brick, Points& points) noexcept {
  auto& [x, y, z, phi] = points;
  if (!copy_around(brick)) {
    for (std::size_t i = 0; i < kPoints; ++i) phi[i] = at(x[i], y[i], z[i]);
    return;
  }
  const double s = field_.spacing_voxels;
  Points scaled;
  for (std::size_t i = 0; i < kPoints; ++i) {
    scaled.x[i] = s * x[i];
    scaled.y[i] = s * y[i];
    scaled.z[i] = s * z[i];
  }
  alignas(64) std::array<double, kPoints> values;
  interpolate_in(*block_, scaled.x.data(), scaled.y.data(), scaled.z.data(), kPoints,
                 values.data());
  for (std::size_t i = 0; i < kPoints; ++i) phi[i] = field_.phi(static_cast<float>(values[i]));
}

bool PhiSampler::inside(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
  if (field_.at_voxels()) {
    const VoxelCoord voxel{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                           static_cast<std::int32_t>(z)};
    return field_.phi(reader_->value(voxel)) < 0;
  }
  const std::array point{static_cast<double>(x), static_cast<double>(y),
                         static_cast<double>(z)};
  if (scene_ != nullptr) return at(point[0], point[1], point[2]) < 0;
  return field_.phi(interpolate_at(*reader_, point, field_.spacing_voxels)) < 0;
}

float PhiSampler::at(double x, double y, double z) noexcept {
  const double s = field_.spacing_voxels;
  if (scene_ != nullptr) return PhiField::clamped(scene_->at({s * x, s * y, s * z}));
  return field_.phi(static_cast<float>(reader_->trilinear({s * x, s * y, s * z})));
}

}  // namespace tet
