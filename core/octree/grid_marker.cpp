#include "core/octree/grid_marker.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "core/base/brick_box.h"
#include "core/base/parallel.h"
#include "core/base/vec3.h"
#include "core/volume/to_voxel.h"

namespace tet {
namespace {

/// A cube of voxels that hold one value.
struct Cube {
  VoxelCoord min;
  int edge = 1;
  float value = 0;
};

/// Cells of a level, the last ones included.
struct CellRange {
  std::array<std::int64_t, 3> first{}, last{};

  double count() const {
    double cells = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cells *= static_cast<double>(std::max<std::int64_t>(0, last[axis] - first[axis] + 1));
    }
    return cells;
  }
};

/// Where a grid's voxels lie on the lattice.
class VoxelPlaces {
 public:
  VoxelPlaces(const Volume& grid, const VoxelTransform& lattice)
      : grid_(grid.transform), to_lattice_(lattice) {
    const Triple origin = at({0, 0, 0});
    for (const VoxelPoint& axis : {VoxelPoint{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      const Triple step = at(axis);
      for (std::size_t i = 0; i < 3; ++i) half_[i] += std::abs(step[i] - origin[i]) / 2;
    }
  }

  /// The cells of a level that the cube reaches into.
  CellRange cells(const Cube& cube, int level) const {
    // Faces that are meant to meet do so within rounding errors; a smaller cube, between two
    // cells, is still in both.
    constexpr double kSame = 1e-6;
    const Triple centre = at(middle(cube));
    CellRange range;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double reach = cube.edge * half_[axis];
      const double half = reach - std::min(kSame, reach / 2);
      range.first[axis] = cell(centre[axis] - half, level);
      range.last[axis] = cell(centre[axis] + half, level);
    }
    return range;
  }

  WorldBox world_box(const Cube& cube) const {
    const auto [x, y, z] = middle(cube);
    const double half = cube.edge / 2.0;
    return grid_.to_world_box({x - half, y - half, z - half}, {x + half, y + half, z + half});
  }

 private:
  static VoxelPoint middle(const Cube& cube) {
    const double half = (cube.edge - 1) / 2.0;
    return {cube.min.x + half, cube.min.y + half, cube.min.z + half};
  }
  Triple at(const VoxelPoint& voxel) const {
    const auto [x, y, z] = to_lattice_(grid_.to_world(voxel));
    return {x, y, z};
  }
  static std::int64_t cell(double at, int level) {
    constexpr double kMost = kMaxVoxelCoord;
    return static_cast<std::int64_t>(
        std::floor(std::ldexp(std::clamp(at, -kMost, kMost), -level)));
  }

  const VoxelTransform grid_;
  const ToVoxel to_lattice_;
  Triple half_{};  ///< of a voxel, along the lattice's axes
};

CellRange within(CellRange range, const BrickBox& bounds, int level) {
  const auto& [min, max] = bounds;
  const std::array<std::int64_t, 3> first{min.x, min.y, min.z}, last{max.x, max.y, max.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    range.first[axis] = std::max(range.first[axis], first[axis] * kBrickEdge >> level);
    range.last[axis] =
        std::min(range.last[axis], (last[axis] * kBrickEdge + kBrickEdge - 1) >> level);
  }
  return range;
}

}  // namespace

/// What one task has marked.
class GridMarker::Marks {
 public:
  Marks(const Volume& grid, const GridMarker& of)
      : cells(static_cast<std::size_t>(of.levels_) + 1),
        places_(grid, of.lattice_),
        spacing_(of.lattice_.voxel_size),
        bounds_(of.bounds_),
        levels_(of.levels_),
        most_(of.most_),
        cancellation_(of.cancellation_),
        of_level_(static_cast<std::size_t>(of.levels_) + 1) {}

  /// True once there are too many, or nobody wants them any more.
  bool full() const { return marked > most_ || cancelled_; }

  /// Adds nothing more to marks that are full.
  void add(const Cube& cube) {
    if (full() || !(cube.value > 0)) return;
    const int level = level_of_size(double{cube.value}, spacing_, levels_) + 1;
    if (level > levels_) return;
    const CellRange range = within(places_.cells(cube, level), bounds_, level);
    // More than these are looked at as a region is: large parts at once.
    constexpr double kMostCells = 1 << 18;
    if (range.count() > kMostCells) {
      large.push_back({cube.value, places_.world_box(cube)});
      return;
    }
    add(range, of_level_[static_cast<std::size_t>(level)]);
    added_ += range.count();
    // Voxels share most of their cells, but large ones do not: what waits is bounded.
    if (added_ > kMostCells) gather();
  }

  /// Cells that were added since the last time, each once.
  void gather() {
    for (std::size_t level = 0; level < of_level_.size(); ++level) {
      for (const auto& [brick, mask] : of_level_[level]) {
        cells[level].add(brick, mask);
        marked += mask.count();
      }
      of_level_[level].clear();
    }
    added_ = 0;
    cancelled_ = cancellation_.requested();
  }

  std::vector<CellSetBuilder> cells;  ///< by level
  double marked = 0;
  std::vector<SizingRegion> large;

 private:
  /// Which of a brick's eight cells along an axis lie in the range.
  static std::uint8_t cells_along(const CellRange& range,
                                  std::size_t axis,
                                  std::int64_t brick) {
    const std::int64_t first =
        std::max(range.first[axis] - kBrickEdge * brick, std::int64_t{0});
    const std::int64_t last =
        std::min(range.last[axis] - kBrickEdge * brick, std::int64_t{kBrickEdge - 1});
    return static_cast<std::uint8_t>((2U << last) - (1U << first));
  }

  static void add(const CellRange& range, std::map<BrickCoord, BrickMask>& marks) {
    if (!(range.count() > 0)) return;
    const auto brick = [](std::int64_t at) { return static_cast<std::int32_t>(at >> 3); };
    const auto& [first, last] = range;
    const BrickBox bricks{{brick(first[0]), brick(first[1]), brick(first[2])},
                          {brick(last[0]), brick(last[1]), brick(last[2])}};
    for_each_brick(bricks, [&](BrickCoord b) {
      marks[b] |= cells_at(cells_along(range, 0, b.x), cells_along(range, 1, b.y),
                           cells_along(range, 2, b.z));
    });
  }

  const VoxelPlaces places_;
  const double spacing_;
  const BrickBox bounds_;
  const int levels_;
  const double most_;
  const Cancellation& cancellation_;
  bool cancelled_ = false;
  double added_ = 0;  ///< since they were gathered, some more than once
  std::vector<std::map<BrickCoord, BrickMask>> of_level_;
};

GridMarker::GridMarker(const VoxelTransform& lattice,
                       const BrickBox& bounds,
                       int levels,
                       double most,
                       const Cancellation& cancellation)
    : lattice_(lattice),
      bounds_(bounds),
      levels_(levels),
      most_(most),
      cancellation_(cancellation),
      of_level_(static_cast<std::size_t>(levels) + 1) {}

void GridMarker::mark(const Volume& grid) {
  mark_bricks(grid);
  mark_constants(grid);
}

void GridMarker::mark_bricks(const Volume& grid) {
  for_each_range(grid.bricks.size(), 64, [&](std::size_t begin, std::size_t end) {
    if (full()) return;
    Marks marks(grid, *this);
    for (std::size_t i = begin; i < end && !cancellation_.requested(); ++i) {
      const BrickCoord b = grid.bricks[i];
      const float* values = grid.values.data() + i * kBrickCells;
      for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
        const VoxelCoord voxel{8 * b.x + x, 8 * b.y + y, 8 * b.z + z};
        marks.add({voxel, 1, *values++});
      });
      marks.gather();
      if (marks.full()) break;
    }
    take(marks);
  });
}

void GridMarker::mark_constants(const Volume& grid) {
  constexpr int kEdge = Region::kEdgeBricks;
  Marks marks(grid, *this);
  for (const ConstantCube& cube : grid.cubes) {
    if (marks.full() || cancellation_.requested()) break;
    marks.add({cube.min, cube.edge, cube.value});
  }
  for (const Region& region : grid.regions) {
    if (marks.full() || cancellation_.requested()) break;
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const auto at = static_cast<std::size_t>(i);
      // The background is the coarsest size everywhere, or none.
      if (region.brick_index[at] != Region::kConstant ||
          region.constant[at] == grid.background) {
        continue;
      }
      const BrickCoord b{region.min.x + i / (kEdge * kEdge), region.min.y + i / kEdge % kEdge,
                         region.min.z + i % kEdge};
      marks.add({{8 * b.x, 8 * b.y, 8 * b.z}, kBrickEdge, region.constant[at]});
    }
    marks.gather();
  }
  marks.gather();
  take(marks);
}

bool GridMarker::full() {
  const std::lock_guard lock(mutex_);
  return marked_ > most_;
}

void GridMarker::take(Marks& marks) {
  const std::lock_guard lock(mutex_);
  marked_ += marks.marked;
  large_.insert(large_.end(), marks.large.begin(), marks.large.end());
  if (marked_ > most_) return;
  for (std::size_t level = 0; level < marks.cells.size(); ++level) {
    of_level_[level].add(std::move(marks.cells[level]));
  }
}

}  // namespace tet
