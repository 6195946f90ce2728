#include "core/field/phi_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>

#include "core/base/vector_clones.h"
#include "core/field/scene_samples.h"
#include "core/scene/scene_evaluator.h"
#include "core/volume/interpolate_lattice.h"

namespace tet {
namespace {

constexpr int kMaxCorner = 10;
constexpr std::size_t kUsedRows = kMaxCorner - kHaloMin + 1;  // of a slice; as many slices

/// What a halo has of the brick before, of the brick itself, and of the one behind, along an
/// axis: its voxels from `first`, and where they are in the halo.
struct Part {
  std::size_t first, count, at;
};
constexpr std::array<Part, 3> kHaloParts{{{6, 2, 0}, {0, 8, 2}, {0, 3, 10}}};

/// Returns one of the 27 bricks at and around a brick: `i` is 9*(x+1) + 3*(y+1) + z+1.
BrickCoord brick_around(BrickCoord brick, int i) noexcept {
  return {brick.x + i / 9 - 1, brick.y + i / 3 % 3 - 1, brick.z + i % 3 - 1};
}

/// The sides of the surface that values lie on.
struct Sides {
  bool inside = false, outside = false;

  bool both() const noexcept { return inside && outside; }
  void add(const Sides& more) noexcept {
    inside = inside || more.inside;
    outside = outside || more.outside;
  }
};

/// Counts the values inside in a part of a brick. Whole rows are looked at, so that they become
/// vectors.
TET_VECTOR_CLONES
std::size_t count_inside(const InsideTestOfValue& inside,
                         const float* values,
                         const Part& x,
                         const Part& y,
                         const Part& z) noexcept {
  const float sign = inside.above ? -1.0F : 1.0F, bar = sign * inside.iso;
  std::array<std::int32_t, 8> meant{}, found{};
  std::fill_n(meant.begin() + static_cast<std::ptrdiff_t>(z.first), z.count, 1);
  for (std::size_t i = 0; i < x.count; ++i) {
    for (std::size_t j = 0; j < y.count; ++j) {
      const float* const row = values + ((x.first + i) * 8 + y.first + j) * 8;
      for (std::size_t k = 0; k < 8; ++k) found[k] += sign * row[k] < bar ? meant[k] : 0;
    }
  }
  return static_cast<std::size_t>(std::accumulate(found.begin(), found.end(), 0));
}

/// Tells on which sides the values in a part of a brick lie.
Sides sides_of(const InsideTestOfValue& inside,
               const VolumeReader::Brick& brick,
               const Part& x,
               const Part& y,
               const Part& z) noexcept {
  const bool min = inside(brick.range.min), max = inside(brick.range.max);
  if (min == max) return {min, !min};
  const std::size_t values = x.count * y.count * z.count;
  if (values == std::size_t{kBrickCells}) return {true, true};  // the range is of all of them
  const std::size_t found = count_inside(inside, brick.values, x, y, z);
  return {found > 0, found < values};
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
    for (std::size_t i = 0; i < x.count; ++i) {
      for (std::size_t j = 0; j < y.count; ++j) {
        float* const row = to + i * kHaloSlice + j * kHaloRow;
        const auto from = [&](int brick) {
          return along_z[brick].row(x.first + i, y.first + j);
        };
        std::memcpy(row, from(0) + 6, 2 * sizeof(float));
        std::memcpy(row + 2, from(1), 8 * sizeof(float));
        std::memcpy(row + 10, from(2), 6 * sizeof(float));
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
  const auto add = [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    sides.add(sides_of(inside, reader_->brick(brick_around(brick, i)), kHaloParts[at / 9],
                       kHaloParts[at / 3 % 3], kHaloParts[at % 3]));
  };
  add(13);  // the brick itself: nearly all that are at the surface have both sides there
  for (int i = 0; i < 27 && !sides.both(); ++i) add(i);
  return !sides.both();
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
  return at(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) < 0;
}

float PhiSampler::at(double x, double y, double z) noexcept {
  const double s = field_.spacing_voxels;
  if (scene_ != nullptr) return PhiField::clamped(scene_->at({s * x, s * y, s * z}));
  return field_.phi(static_cast<float>(reader_->trilinear({s * x, s * y, s * z})));
}

}  // namespace tet
