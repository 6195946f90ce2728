#include "core/volume/volume_builder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace tet {
namespace {

std::string to_string(VoxelCoord v) { return absl::StrFormat("(%d, %d, %d)", v.x, v.y, v.z); }

/// The lowest corner of the aligned cube of `edge` voxels around `v`; `edge` is a power of two.
VoxelCoord align_down(VoxelCoord v, std::int32_t edge) noexcept {
  const std::int32_t mask = ~(edge - 1);
  return {v.x & mask, v.y & mask, v.z & mask};
}

VoxelCoord min_voxel(BrickCoord b) noexcept {
  return {b.x * kBrickEdge, b.y * kBrickEdge, b.z * kBrickEdge};
}

BrickCoord region_of(BrickCoord b) noexcept {
  constexpr std::int32_t kMask = ~(Region::kEdgeBricks - 1);
  return {b.x & kMask, b.y & kMask, b.z & kMask};
}

std::size_t index_in_region(BrickCoord b) noexcept {
  const auto low = [](std::int32_t v) {
    return static_cast<std::size_t>(v & (Region::kEdgeBricks - 1));
  };
  return (low(b.x) * Region::kEdgeBricks + low(b.y)) * Region::kEdgeBricks + low(b.z);
}

/// Range of a brick's values; NaN twice when one of them is not finite.
ValueRange range_of(const float* values) noexcept {
  // Eight lanes, so that the loop becomes vector instructions.
  constexpr std::size_t kLanes = 8;
  std::array<float, kLanes> min, max, poison{};
  std::copy_n(values, kLanes, min.begin());
  max = min;
  for (std::size_t i = 0; i < kBrickCells; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float v = values[i + lane];
      min[lane] = v < min[lane] ? v : min[lane];
      max[lane] = v > max[lane] ? v : max[lane];
      poison[lane] += v * 0.0F;  // NaN from then on when v is NaN or infinite
    }
  }
  if (std::accumulate(poison.begin(), poison.end(), 0.0F) != 0) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    return {kNan, kNan};
  }
  return {*std::min_element(min.begin(), min.end()), *std::max_element(max.begin(), max.end())};
}

/// Bricks of 2 KiB, or regions of 32 KiB.
constexpr std::size_t kBetweenLooks = 512;

absl::Status not_finite(VoxelCoord voxel, float value) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "voxel %s is %g; every value must be finite: replace it before meshing, with the "
      "background for example",
      to_string(voxel), value));
}

absl::Status check_extent(VoxelCoord min, std::int32_t edge) {
  for (const std::int32_t low : {min.x, min.y, min.z}) {
    const std::int64_t high = std::int64_t{low} + edge - 1;
    const std::int64_t farthest = low < 0 && -std::int64_t{low} > high ? low : high;
    if (std::abs(farthest) > kMaxVoxelCoord) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "voxel coordinate %d is beyond the limit of %d: move the grid closer to the origin "
          "of index space",
          farthest, kMaxVoxelCoord));
    }
  }
  return absl::OkStatus();
}

absl::Status check_cube(const ConstantCube& cube) {
  if (cube.edge != kRegionVoxels && cube.edge != kLargestCube) {
    return absl::InvalidArgumentError(
        absl::StrFormat("a constant cube has an edge of %d voxels; it must be %d or %d",
                        cube.edge, kRegionVoxels, kLargestCube));
  }
  if (align_down(cube.min, cube.edge) != cube.min) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the constant cube at %s is not aligned to its edge of %d voxels",
                        to_string(cube.min), cube.edge));
  }
  if (!std::isfinite(cube.value)) return not_finite(cube.min, cube.value);
  return check_extent(cube.min, cube.edge);
}

absl::Status check_constants(const Volume& volume,
                             const std::vector<ConstantBrick>& constants) {
  if (absl::Status s = check_background(volume.background); !s.ok()) return s;
  for (const ConstantBrick& constant : constants) {
    const VoxelCoord min = min_voxel(constant.brick);
    if (!std::isfinite(constant.value)) return not_finite(min, constant.value);
    if (absl::Status s = check_extent(min, kBrickEdge); !s.ok()) return s;
  }
  for (const ConstantCube& cube : volume.cubes) {
    if (absl::Status s = check_cube(cube); !s.ok()) return s;
  }
  return absl::OkStatus();
}

absl::Status measure_ranges(Volume& volume, const Cancellation& cancellation) {
  volume.ranges.resize(volume.bricks.size());
  for_each_range(volume.bricks.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kBetweenLooks == 0 && cancellation.requested()) return;
      volume.ranges[i] = range_of(&volume.values[i * kBrickCells]);
    }
  });
  if (absl::Status s = check_cancelled(cancellation); !s.ok()) return s;
  for (std::size_t i = 0; i < volume.bricks.size(); ++i) {
    const VoxelCoord min = min_voxel(volume.bricks[i]);
    if (absl::Status s = check_extent(min, kBrickEdge); !s.ok()) return s;
    if (std::isfinite(volume.ranges[i].min)) continue;
    for (int cell = 0; cell < kBrickCells; ++cell) {
      const float v = volume.values[i * kBrickCells + static_cast<std::size_t>(cell)];
      const VoxelCoord at{min.x + cell / 64, min.y + cell / 8 % 8, min.z + cell % 8};
      if (!std::isfinite(v)) return not_finite(at, v);
    }
  }
  return absl::OkStatus();
}

absl::Status make_regions(Volume& volume,
                          const std::vector<ConstantBrick>& constants,
                          const Cancellation& cancellation) {
  std::vector<BrickCoord> mins;
  const auto add = [&](BrickCoord brick) {
    const BrickCoord min = region_of(brick);
    if (mins.empty() || mins.back() != min) mins.push_back(min);
  };
  for (const BrickCoord brick : volume.bricks) add(brick);
  for (const ConstantBrick& constant : constants) add(constant.brick);
  std::sort(mins.begin(), mins.end());
  mins.erase(std::unique(mins.begin(), mins.end()), mins.end());

  volume.regions.resize(mins.size());
  for_each_index(mins.size(), [&](std::size_t i) {
    if (i % kBetweenLooks == 0 && cancellation.requested()) return;
    Region& region = volume.regions[i];
    region.min = mins[i];
    region.brick_index.fill(Region::kConstant);
    region.constant.fill(volume.background);
  });
  return check_cancelled(cancellation);
}

Region& find_region(Volume& volume, BrickCoord brick) {
  const auto it =
      std::lower_bound(volume.regions.begin(), volume.regions.end(), region_of(brick),
                       [](const Region& region, BrickCoord min) { return region.min < min; });
  TET_CHECK(it != volume.regions.end());
  return *it;
}

absl::Status brick_twice(BrickCoord brick) {
  return absl::InvalidArgumentError(
      absl::StrFormat("the brick at voxel %s is given twice", to_string(min_voxel(brick))));
}

absl::Status fill_regions(Volume& volume, std::vector<ConstantBrick>& constants) {
  for (std::size_t i = 0; i < volume.bricks.size(); ++i) {
    const BrickCoord brick = volume.bricks[i];
    if (i > 0 && brick == volume.bricks[i - 1]) return brick_twice(brick);
    find_region(volume, brick).brick_index[index_in_region(brick)] =
        static_cast<std::uint32_t>(i);
  }
  std::sort(constants.begin(), constants.end(),
            [](const ConstantBrick& a, const ConstantBrick& b) { return a.brick < b.brick; });
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const auto& [brick, value] = constants[i];
    Region& region = find_region(volume, brick);
    const std::size_t at = index_in_region(brick);
    const bool again = i > 0 && brick == constants[i - 1].brick;
    if (again || region.brick_index[at] != Region::kConstant) return brick_twice(brick);
    region.constant[at] = value;
  }
  return absl::OkStatus();
}

/// True when a cube of `edge` voxels is where `voxel` lies.
bool covered(const std::vector<ConstantCube>& cubes, VoxelCoord voxel, std::int32_t edge) {
  const VoxelCoord min = align_down(voxel, edge);
  const auto [first, last] = std::equal_range(
      cubes.begin(), cubes.end(), ConstantCube{min, edge, 0},
      [](const ConstantCube& a, const ConstantCube& b) { return a.min < b.min; });
  return std::any_of(first, last, [&](const ConstantCube& c) { return c.edge == edge; });
}

absl::Status place_cubes(Volume& volume) {
  auto& cubes = volume.cubes;
  std::sort(cubes.begin(), cubes.end(),
            [](const ConstantCube& a, const ConstantCube& b) { return a.min < b.min; });
  // Few of them: to look for them alone is quicker than among the small ones.
  std::vector<ConstantCube> largest;
  std::ranges::copy_if(cubes, std::back_inserter(largest),
                       [](const ConstantCube& cube) { return cube.edge == kLargestCube; });
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    const bool again = i > 0 && cubes[i].min == cubes[i - 1].min;
    if (again ||
        (cubes[i].edge != kLargestCube && covered(largest, cubes[i].min, kLargestCube))) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the constant cube at %s overlaps another", to_string(cubes[i].min)));
    }
  }
  for (const Region& region : volume.regions) {
    const VoxelCoord min = min_voxel(region.min);
    if (covered(cubes, min, kRegionVoxels) || covered(largest, min, kLargestCube)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("a constant cube overlaps bricks near voxel %s", to_string(min)));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status check_background(float background) {
  if (std::isfinite(background)) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("the background value is %g; it must be finite", background));
}

absl::StatusOr<Volume> index_volume(Volume volume,
                                    std::vector<ConstantBrick> constants,
                                    const Cancellation& cancellation) {
  TET_CHECK(std::is_sorted(volume.bricks.begin(), volume.bricks.end()));
  TET_CHECK(volume.values.size() == volume.bricks.size() * kBrickCells);
  if (absl::Status s = check_constants(volume, constants); !s.ok()) return s;
  if (absl::Status s = measure_ranges(volume, cancellation); !s.ok()) return s;
  if (absl::Status s = make_regions(volume, constants, cancellation); !s.ok()) return s;
  if (absl::Status s = fill_regions(volume, constants); !s.ok()) return s;
  if (absl::Status s = place_cubes(volume); !s.ok()) return s;
  return volume;
}

VolumeBuilder::VolumeBuilder(VolumeKind kind,
                             float background,
                             const VoxelTransform& transform) {
  volume_.kind = kind;
  volume_.background = background;
  volume_.transform = transform;
}

void VolumeBuilder::add_brick(BrickCoord brick, std::span<const float, kBrickCells> values) {
  volume_.bricks.push_back(brick);
  volume_.values.insert(volume_.values.end(), values.begin(), values.end());
}

void VolumeBuilder::add_constant_brick(BrickCoord brick, float value) {
  constants_.push_back({brick, value});
}

void VolumeBuilder::add_constant_cube(VoxelCoord min, std::int32_t edge, float value) {
  volume_.cubes.push_back({min, edge, value});
}

absl::StatusOr<Volume> VolumeBuilder::build() && {
  std::vector<std::size_t> order(volume_.bricks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return volume_.bricks[a] < volume_.bricks[b];
  });
  const std::vector<BrickCoord> bricks = std::exchange(volume_.bricks, {});
  const std::vector<float> values = std::exchange(volume_.values, {});
  volume_.values.reserve(values.size());
  for (const std::size_t i : order) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(i * kBrickCells);
    volume_.bricks.push_back(bricks[i]);
    volume_.values.insert(volume_.values.end(), first, first + kBrickCells);
  }
  return index_volume(std::move(volume_), std::move(constants_));
}

}  // namespace tet
