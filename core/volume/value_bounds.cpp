#include "core/volume/value_bounds.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr std::size_t kLargeCubeLevel = 5;  // whose cells are as large as large cubes
constexpr std::size_t kFewCells = 8;        // there are no more from level 23 on
constexpr std::int32_t kMostBricks = 8, kMostCells = 3;  // along an axis, looked at one by one

void widen(ValueRange& range, const ValueRange& by) noexcept {
  range = {std::min(range.min, by.min), std::max(range.max, by.max)};
}

BrickCoord shifted(const BrickCoord& at, int down) noexcept {
  return {at.x >> down, at.y >> down, at.z >> down};
}

BrickCoord cell_of(const VoxelCoord& voxel, int shift) noexcept {
  return {voxel.x >> shift, voxel.y >> shift, voxel.z >> shift};
}

/// The cells of an edge that meet a box.
struct CellBox {
  BrickCoord min, max;

  CellBox(const VoxelBox& box, int shift) noexcept
      : min(cell_of(box.min, shift)), max(cell_of(box.max, shift)) {}

  bool at_most(std::int32_t along_an_axis) const noexcept {
    return max.x - min.x < along_an_axis && max.y - min.y < along_an_axis &&
           max.z - min.z < along_an_axis;
  }
  bool holds(const BrickCoord& at) const noexcept {
    return at.x >= min.x && at.y >= min.y && at.z >= min.z && at.x <= max.x && at.y <= max.y &&
           at.z <= max.z;
  }
  template <class Visit>
  void for_each(const Visit& visit) const noexcept {
    for (std::int32_t x = min.x; x <= max.x; ++x) {
      for (std::int32_t y = min.y; y <= max.y; ++y) {
        for (std::int32_t z = min.z; z <= max.z; ++z) visit(BrickCoord{x, y, z});
      }
    }
  }
};

ValueRange range_of(const Volume& volume, const Region& region) {
  ValueRange range{volume.background, volume.background};
  bool first = true;
  for (std::size_t i = 0; i < region.brick_index.size(); ++i) {
    const std::uint32_t index = region.brick_index[i];
    const ValueRange brick = index == Region::kConstant
                                 ? ValueRange{region.constant[i], region.constant[i]}
                                 : volume.ranges[index];
    if (std::exchange(first, false)) range = brick;
    widen(range, brick);
  }
  return range;
}

/// Returns the range of those of a brick's values that lie in the box.
ValueRange range_of(const float* values, const BrickCoord& brick, const VoxelBox& box) {
  const auto first = [](std::int32_t at, std::int32_t min) {
    return std::max(min - kBrickEdge * at, 0);
  };
  const auto last = [](std::int32_t at, std::int32_t max) {
    return std::min(max - kBrickEdge * at, kBrickEdge - 1);
  };
  const std::int32_t y0 = first(brick.y, box.min.y), y1 = last(brick.y, box.max.y);
  const std::int32_t z0 = first(brick.z, box.min.z), z1 = last(brick.z, box.max.z);
  const std::int32_t x0 = first(brick.x, box.min.x), x1 = last(brick.x, box.max.x);
  const float any = values[(x0 * kBrickEdge + y0) * kBrickEdge + z0];
  ValueRange range{any, any};
  for (std::int32_t x = x0; x <= x1; ++x) {
    for (std::int32_t y = y0; y <= y1; ++y) {
      const float* const row = values + (x * kBrickEdge + y) * kBrickEdge;
      for (std::int32_t z = z0; z <= z1; ++z) widen(range, {row[z], row[z]});
    }
  }
  return range;
}

ValueRange of_bricks(VolumeReader& reader, const VoxelBox& box) noexcept {
  const auto edge = [](std::int32_t min, std::int32_t max) { return 1.0 + max - min; };
  const bool one_by_one =
      edge(box.min.x, box.max.x) * edge(box.min.y, box.max.y) * edge(box.min.z, box.max.z) <=
      ValueBounds::kFewVoxels;
  const float any = reader.value(box.min);
  ValueRange range{any, any};
  CellBox(box, kBrickShift).for_each([&](const BrickCoord& at) {
    const VolumeReader::Brick brick = reader.brick(at);
    if (brick.range.min >= range.min && brick.range.max <= range.max) return;
    widen(range, one_by_one && brick.values != nullptr ? range_of(brick.values, at, box)
                                                       : brick.range);
  });
  return range;
}

bool comes_first(const ValueBounds::Cell& a, const ValueBounds::Cell& b) noexcept {
  return a.at < b.at;
}

ValueBounds::Level cells_of_regions(const std::vector<Region>& regions, const Volume& volume) {
  ValueBounds::Level cells(regions.size());
  for_each_index(cells.size(), [&](std::size_t i) {
    cells[i] = {shifted(regions[i].min, kRegionShift - kBrickShift),
                range_of(volume, regions[i])};
  });
  return cells;
}

void add_cubes(const Volume& volume, int shift, ValueBounds::Level& cells) {
  for (const ConstantCube& cube : volume.cubes) {
    if (cube.edge != 1 << shift) continue;
    cells.push_back({cell_of(cube.min, shift), {cube.value, cube.value}});
  }
  std::sort(cells.begin(), cells.end(), comes_first);
}

/// Cells of twice the edge. What is missing of one is background: a large cube's cells have no
/// brothers that are anything else.
ValueBounds::Level twice_as_large(ValueBounds::Level cells, const ValueRange& background) {
  for (ValueBounds::Cell& cell : cells) cell.at = shifted(cell.at, 1);
  std::sort(cells.begin(), cells.end(), comes_first);
  ValueBounds::Level parents;
  for (std::size_t i = 0; i < cells.size();) {
    ValueBounds::Cell parent = cells[i];
    std::size_t children = 0;
    for (; i < cells.size() && cells[i].at == parent.at; ++i, ++children) {
      widen(parent.range, cells[i].range);
    }
    if (children < 8) widen(parent.range, background);
    parents.push_back(parent);
  }
  return parents;
}

}  // namespace

ValueBounds::ValueBounds(const Volume& volume)
    : background_{volume.background, volume.background}, all_(background_) {
  levels_.push_back(cells_of_regions(volume.regions, volume));
  add_cubes(volume, kRegionShift, levels_.back());
  while (levels_.size() <= kLargeCubeLevel || levels_.back().size() > kFewCells) {
    levels_.push_back(twice_as_large(levels_.back(), background_));
    if (levels_.size() != kLargeCubeLevel + 1) continue;
    add_cubes(volume, kRegionShift + static_cast<int>(kLargeCubeLevel), levels_.back());
  }
  for (const Cell& cell : levels_.back()) widen(all_, cell.range);
}

ValueRange ValueBounds::within(VolumeReader& reader, const VoxelBox& box) const noexcept {
  if (CellBox(box, kBrickShift).at_most(kMostBricks)) return of_bricks(reader, box);
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const int shift = kRegionShift + static_cast<int>(level);
    if (CellBox(box, shift).at_most(kMostCells)) return of_cells(reader, level, box);
  }
  return of_few(box);
}

ValueRange ValueBounds::of_cells(VolumeReader& reader,
                                 std::size_t level,
                                 const VoxelBox& box) const noexcept {
  const Level& cells = levels_[level];
  const int shift = static_cast<int>(level) + kRegionShift - kBrickShift;
  const auto range_at = [&](const BrickCoord& at) -> ValueRange {
    const auto found =
        std::lower_bound(cells.begin(), cells.end(), at,
                         [](const Cell& cell, const BrickCoord& to) { return cell.at < to; });
    if (found != cells.end() && found->at == at) return found->range;
    const float constant =
        reader.region({at.x << shift, at.y << shift, at.z << shift}).constant;
    return {constant, constant};
  };
  const CellBox met(box, kRegionShift + static_cast<int>(level));
  ValueRange range = range_at(met.min);
  met.for_each([&](const BrickCoord& at) { widen(range, range_at(at)); });
  return range;
}

ValueRange ValueBounds::of_few(const VoxelBox& box) const noexcept {
  const CellBox met(box, kRegionShift + static_cast<int>(levels_.size() - 1));
  ValueRange range = background_;
  for (const Cell& cell : levels_.back()) {
    if (met.holds(cell.at)) widen(range, cell.range);
  }
  return range;
}

}  // namespace tet
