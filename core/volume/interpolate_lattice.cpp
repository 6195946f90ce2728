#include "core/volume/interpolate_lattice.h"

#include <algorithm>
#include <cmath>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

constexpr std::size_t kEdge = kBrickEdge;
constexpr std::size_t kMaxVoxels = 2 * AxisPoints::kMax;  // along an axis

/// Blends two values. The result never lies beyond them: rounding alone may put it there, even
/// where both are the same, and bricks are told apart by the values of voxels.
inline float blend(float low, float high, float weight) noexcept {
  const float between = (1 - weight) * low + weight * high;
  return std::min(std::max(between, std::min(low, high)), std::max(low, high));
}

TET_VECTOR_CLONES
void blend_rows(const float* __restrict low,
                const float* __restrict high,
                float weight,
                std::size_t bricks,
                float* __restrict out) noexcept {
  for (std::size_t b = 0; b < bricks; ++b) {
    for (std::size_t i = b * kEdge; i < (b + 1) * kEdge; ++i) {
      out[i] = blend(low[i], high[i], weight);
    }
  }
}

/// Bricks that some voxels along an axis lie in.
struct AxisBricks {
  std::array<std::int32_t, kMaxVoxels> brick;
  std::array<std::size_t, kMaxVoxels> of_voxel;  ///< by the voxel's number
  std::size_t count = 0;

  explicit AxisBricks(const AxisPoints& points) noexcept {
    for (std::size_t i = 0; i < points.voxels(); ++i) {
      const std::int32_t at = points.voxel(i) >> 3;
      if (count == 0 || brick[count - 1] != at) brick[count++] = at;
      of_voxel[i] = count - 1;
    }
  }
};

/// The rows of voxels along z that the lattice needs, brick by brick: `kEdge` values of each.
class VoxelRows {
 public:
  VoxelRows(VolumeReader& reader, const AxisPoints& y, const AxisPoints& z) noexcept
      : reader_(reader), y_(y), bricks_y_(y), bricks_z_(z) {}

  const AxisBricks& bricks_z() const noexcept { return bricks_z_; }

  /// Rows blend the slices of voxels at x and x + 1: one for each voxel along y.
  using Rows = std::array<std::array<float, kMaxVoxels * kEdge>, kMaxVoxels>;
  void blend_slices(std::int32_t x, float weight, Rows& rows) noexcept {
    const Slice &low = slice_at(x), &high = slice_at(x + 1);
    for (std::size_t i = 0; i < y_.voxels(); ++i) {
      const auto row = static_cast<std::size_t>(y_.voxel(i) & 7);
      const std::size_t first = bricks_y_.of_voxel[i] * kMaxVoxels;
      for (std::size_t b = 0; b < bricks_z_.count; ++b) {
        std::array<float, kEdge> constant_low, constant_high;
        blend_rows(row_of(low.brick[first + b], x, row, constant_low),
                   row_of(high.brick[first + b], x + 1, row, constant_high), weight, 1,
                   &rows[i][b * kEdge]);
      }
    }
  }

 private:
  /// The bricks at one brick coordinate along x, by those along y and z.
  struct Slice {
    bool known = false;
    std::int32_t x = 0;
    std::array<VolumeReader::Brick, kMaxVoxels * kMaxVoxels> brick;
  };

  /// Remembers two: those of a voxel and of the next.
  const Slice& slice_at(std::int32_t voxel_x) noexcept {
    const std::int32_t x = voxel_x >> 3;
    Slice& slice = slice_[static_cast<std::size_t>(x & 1)];
    if (slice.known && slice.x == x) return slice;
    slice.known = true;
    slice.x = x;
    for (std::size_t j = 0; j < bricks_y_.count; ++j) {
      for (std::size_t k = 0; k < bricks_z_.count; ++k) {
        slice.brick[j * kMaxVoxels + k] =
            reader_.brick({x, bricks_y_.brick[j], bricks_z_.brick[k]});
      }
    }
    return slice;
  }

  static const float* row_of(const VolumeReader::Brick& brick,
                             std::int32_t x,
                             std::size_t y,
                             std::array<float, kEdge>& constant) noexcept {
    if (brick.values != nullptr) {
      return brick.values + (static_cast<std::size_t>(x & 7) * kEdge + y) * kEdge;
    }
    constant.fill(brick.range.min);
    return constant.data();
  }

  VolumeReader& reader_;
  const AxisPoints& y_;
  AxisBricks bricks_y_, bricks_z_;
  std::array<Slice, 2> slice_;
};

/// Where the points along z are in a row of voxels.
struct RowPoints {
  std::array<std::size_t, AxisPoints::kMax> before{}, behind{};
  alignas(64) std::array<float, AxisPoints::kMax> weight{};

  RowPoints(const AxisPoints& z, const AxisBricks& bricks) noexcept {
    const auto place = [&](std::size_t i) {
      return bricks.of_voxel[i] * kEdge + static_cast<std::size_t>(z.voxel(i) & 7);
    };
    for (std::size_t k = 0; k < z.count(); ++k) {
      before[k] = place(z.before(k));
      behind[k] = place(z.before(k) + 1);
      weight[k] = z.weight(k);
    }
  }

  void pick(const float* row, float* values) const noexcept {
    alignas(64) std::array<float, AxisPoints::kMax> low, high;
    for (std::size_t k = 0; k < AxisPoints::kMax; ++k) {
      low[k] = row[before[k]];
      high[k] = row[behind[k]];
    }
    for (std::size_t k = 0; k < AxisPoints::kMax; ++k) {
      values[k] = blend(low[k], high[k], weight[k]);
    }
  }
};

}  // namespace

AxisPoints::AxisPoints(double first, std::size_t count, double spacing_voxels) noexcept
    : count_(count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double at = spacing_voxels * (first + static_cast<double>(i));
    const double voxel = std::floor(at);
    const auto before = static_cast<std::int32_t>(voxel);
    weight_[i] = static_cast<float>(at - voxel);
    if (voxels_ == 0 || voxel_[voxels_ - 1] < before) voxel_[voxels_++] = before;
    if (voxel_[voxels_ - 1] == before) voxel_[voxels_++] = before + 1;
    before_[i] = voxels_ - 2;
  }
}

void interpolate_lattice(VolumeReader& reader,
                         const AxisPoints& x,
                         const AxisPoints& y,
                         const AxisPoints& z,
                         std::array<float, kHaloNodes>& values) noexcept {
  VoxelRows voxels(reader, y, z);
  const RowPoints along_z(z, voxels.bricks_z());
  VoxelRows::Rows rows;
  std::array<float, kMaxVoxels * kEdge> row;
  for (std::size_t i = 0; i < x.count(); ++i) {
    voxels.blend_slices(x.voxel(x.before(i)), x.weight(i), rows);
    for (std::size_t j = 0; j < y.count(); ++j) {
      blend_rows(rows[y.before(j)].data(), rows[y.before(j) + 1].data(), y.weight(j),
                 voxels.bricks_z().count, row.data());
      along_z.pick(row.data(), &values[(i * 16 + j) * 16]);
    }
  }
}

float interpolate_at(VolumeReader& reader,
                     const std::array<double, 3>& point,
                     double spacing_voxels) noexcept {
  const AxisPoints x(point[0], 1, spacing_voxels), y(point[1], 1, spacing_voxels),
      z(point[2], 1, spacing_voxels);
  const auto along_x = [&](std::size_t j, std::size_t k) {
    const auto value = [&](std::size_t i) {
      return reader.value({x.voxel(i), y.voxel(j), z.voxel(k)});
    };
    return blend(value(0), value(1), x.weight(0));
  };
  const auto along_y = [&](std::size_t k) {
    return blend(along_x(0, k), along_x(1, k), y.weight(0));
  };
  return blend(along_y(0), along_y(1), z.weight(0));
}

}  // namespace tet
