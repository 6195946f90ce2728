#include "core/volume/point_sampler.h"

#include <algorithm>

#include "core/base/vector_clones.h"
#include "core/volume/to_voxel.h"
#include "core/volume/voxel_block.h"

namespace tet {
namespace {

using Places = PointSampler::Places;
using Block = PointSampler::Block;

/// Beyond all that a volume may store there is background, however far.
constexpr double kFarthest = kMaxVoxelCoord + 16;

/// Not a number counts as far away, too.
inline double within_reach(double at) noexcept {
  const double low = at > -kFarthest ? at : -kFarthest;
  return low < kFarthest ? low : kFarthest;
}

inline double between(double low, double high, double weight) noexcept {
  return low + weight * (high - low);
}

/// The other way round.
VoxelTransform inverse(const VoxelTransform& transform) noexcept {
  VoxelTransform inverse = transform;
  inverse.linear = InverseLinear(transform).matrix();
  return inverse;
}

/// Takes the whole voxels out of coordinates, and leaves what is beyond them. Loops apart, and
/// a floor of our own, or they would not become vector instructions.
TET_VECTOR_CLONES
void split(std::int32_t* __restrict voxels, double* __restrict at, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) at[i] = within_reach(at[i]);
  for (std::size_t i = 0; i < count; ++i) {
    const auto toward_zero = static_cast<double>(static_cast<std::int32_t>(at[i]));
    const double voxel = toward_zero - (toward_zero > at[i] ? 1.0 : 0.0);
    voxels[i] = static_cast<std::int32_t>(voxel);
    at[i] -= voxel;
  }
}

TET_VECTOR_CLONES
void locate(const VoxelTransform& to_voxel,
            const PointSampler::Points& __restrict points,
            Places& __restrict places) noexcept {
  const auto& from = to_voxel.translation;
  const double* const __restrict px = points.at[0].data();
  const double* const __restrict py = points.at[1].data();
  const double* const __restrict pz = points.at[2].data();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [x, y, z] = to_voxel.linear[axis];
    double* const __restrict at = places.weight[axis].data();
    for (std::size_t i = 0; i < points.count; ++i) {
      at[i] = x * (px[i] - from[0]) + y * (py[i] - from[1]) + z * (pz[i] - from[2]);
    }
    split(places.voxel[axis].data(), at, points.count);
  }
}

/// Interpolates at points whose voxels are all in the block.
TET_VECTOR_CLONES
void interpolate(const Block& __restrict block,
                 const Places& __restrict places,
                 std::size_t begin,
                 std::size_t end,
                 float* __restrict values) noexcept {
  const float* const v = block.values.data();
  const VoxelCoord min = block.box.min;
  const std::int32_t row = block.row, slice = block.row * block.rows;
  for (std::size_t i = begin; i < end; ++i) {
    const std::int32_t at = (places.voxel[0][i] - min.x) * slice +
                            (places.voxel[1][i] - min.y) * row + (places.voxel[2][i] - min.z);
    const double x = places.weight[0][i], y = places.weight[1][i], z = places.weight[2][i];
    const double a = between(v[at], v[at + 1], z);
    const double b = between(v[at + row], v[at + row + 1], z);
    const double c = between(v[at + slice], v[at + slice + 1], z);
    const double d = between(v[at + slice + row], v[at + slice + row + 1], z);
    values[i - begin] = static_cast<float>(between(between(a, b, y), between(c, d, y), x));
  }
}

/// Interpolates at one point, wherever its voxels are.
float interpolate(VolumeReader& reader, const Places& places, std::size_t i) noexcept {
  const VolumeReader::Cell v =
      reader.cell({places.voxel[0][i], places.voxel[1][i], places.voxel[2][i]});
  const double x = places.weight[0][i], y = places.weight[1][i], z = places.weight[2][i];
  const double low = between(between(v[0], v[1], z), between(v[2], v[3], z), y);
  const double high = between(between(v[4], v[5], z), between(v[6], v[7], z), y);
  return static_cast<float>(between(low, high, x));
}

/// Widened by the eight voxels of a point.
VoxelBox with_point(const VoxelBox& box, const Places& places, std::size_t i) noexcept {
  const VoxelCoord at{places.voxel[0][i], places.voxel[1][i], places.voxel[2][i]};
  return {{std::min(box.min.x, at.x), std::min(box.min.y, at.y), std::min(box.min.z, at.z)},
          {std::max(box.max.x, at.x + 1), std::max(box.max.y, at.y + 1),
           std::max(box.max.z, at.z + 1)}};
}

/// Up to which of the points, from `begin` on, all lie in one block, the box of which is set.
std::size_t end_of_run(const Places& places,
                       std::size_t begin,
                       std::size_t count,
                       VoxelBox& box) noexcept {
  const std::int32_t x = places.voxel[0][begin], y = places.voxel[1][begin];
  const std::int32_t z = places.voxel[2][begin];
  box = {{x, y, z}, {x + 1, y + 1, z + 1}};
  for (std::size_t end = begin + 1; end < count; ++end) {
    const VoxelBox wider = with_point(box, places, end);
    if (voxels_in(wider) > Block::kMaxVoxels) return end;
    box = wider;
  }
  return count;
}

}  // namespace

PointSampler::PointSampler(std::span<const std::shared_ptr<const Volume>> components)
    : to_voxel_(inverse(components.front()->transform)) {
  for (const auto& volume : components) readers_.emplace_back(*volume);
}

void PointSampler::sample_run(std::size_t begin,
                              std::size_t end,
                              Workspace& workspace,
                              float* values,
                              std::size_t stride) noexcept {
  auto& [places, block, found] = workspace;
  const auto points = static_cast<std::int64_t>(end - begin);
  const bool together = voxels_in(block.box) <= kVoxelsPerPoint * points;
  block.rows = block.box.max.y - block.box.min.y + 1;
  block.row = block.box.max.z - block.box.min.z + 1;
  for (std::size_t c = 0; c < readers_.size(); ++c) {
    if (together) {
      copy_voxels(readers_[c], block.box, block.values.data());
      interpolate(block, places, begin, end, found.data());
    } else {
      for (std::size_t i = begin; i < end; ++i) {
        found[i - begin] = interpolate(readers_[c], places, i);
      }
    }
    for (std::size_t i = begin; i < end; ++i) values[i * stride + c] = found[i - begin];
  }
}

void PointSampler::sample(const Points& points,
                          Workspace& workspace,
                          float* values,
                          std::size_t stride) noexcept {
  auto& [places, block, found] = workspace;
  if (points.count == 0) return;
  locate(to_voxel_, points, places);
  block.box = box_of_cells(places.voxel[0].data(), places.voxel[1].data(),
                           places.voxel[2].data(), points.count);
  if (voxels_in(block.box) <= Block::kMaxVoxels) {
    return sample_run(0, points.count, workspace, values, stride);
  }
  for (std::size_t begin = 0; begin < points.count;) {
    const std::size_t end = end_of_run(places, begin, points.count, block.box);
    sample_run(begin, end, workspace, values, stride);
    begin = end;
  }
}

}  // namespace tet
