#include "core/volume/volume_reader.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tet {
namespace {

const ConstantCube* find_cube(const std::vector<ConstantCube>& cubes,
                              BrickCoord region_min,
                              std::int32_t edge) noexcept {
  const auto down = [&](std::int32_t brick) { return (brick << kBrickShift) & ~(edge - 1); };
  const VoxelCoord min{down(region_min.x), down(region_min.y), down(region_min.z)};
  const auto it = std::lower_bound(
      cubes.begin(), cubes.end(), min,
      [](const ConstantCube& cube, const VoxelCoord& at) { return cube.min < at; });
  return it != cubes.end() && it->min == min && it->edge == edge ? &*it : nullptr;
}

}  // namespace

void VolumeReader::find_region(BrickCoord region_min) noexcept {
  entered_ = true;
  region_min_ = region_min;
  const auto& regions = volume_->regions;
  const auto it = std::lower_bound(
      regions.begin(), regions.end(), region_min,
      [](const Region& region, const BrickCoord& at) { return region.min < at; });
  region_ = it != regions.end() && it->min == region_min ? &*it : nullptr;
  if (region_ != nullptr) return;
  constant_ = volume_->background;
  for (const std::int32_t edge : {128, 4096}) {
    if (const ConstantCube* cube = find_cube(volume_->cubes, region_min, edge)) {
      constant_ = cube->value;
      return;
    }
  }
}

VolumeReader::RegionOrConstant VolumeReader::region(BrickCoord region_min) noexcept {
  enter(region_min);
  return {region_, constant_};
}

VolumeReader::Cell VolumeReader::cell(VoxelCoord min) noexcept {
  Cell cell;
  if ((min.x & 7) < 7 && (min.y & 7) < 7 && (min.z & 7) < 7) {
    const Brick found =
        brick({min.x >> kBrickShift, min.y >> kBrickShift, min.z >> kBrickShift});
    if (found.values == nullptr) {
      cell.fill(found.range.min);
      return cell;
    }
    const float* first = found.values + ((min.x & 7) * 8 + (min.y & 7)) * 8 + (min.z & 7);
    for (std::size_t i = 0; i < 8; ++i) {
      cell[i] = first[(i >> 2) * 64 + (i >> 1 & 1) * 8 + (i & 1)];
    }
    return cell;
  }
  for (int i = 0; i < 8; ++i) {
    cell[static_cast<std::size_t>(i)] =
        value({min.x + (i >> 2), min.y + (i >> 1 & 1), min.z + (i & 1)});
  }
  return cell;
}

double VolumeReader::trilinear(const VoxelPoint& p) noexcept {
  const double x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
  const Cell values = cell({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                            static_cast<std::int32_t>(z)});
  const auto along_z = [&](std::size_t i, std::size_t j) {
    const double low = values[4 * i + 2 * j], high = values[4 * i + 2 * j + 1];
    return low + (p.z - z) * (high - low);
  };
  const auto along_y = [&](std::size_t i) {
    const double low = along_z(i, 0);
    return low + (p.y - y) * (along_z(i, 1) - low);
  };
  const double low = along_y(0);
  return low + (p.x - x) * (along_y(1) - low);
}

}  // namespace tet
