#include "core/vdb/openvdb/copy_labels.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/vdb/openvdb/vdb_transform.h"
#include "core/vdb/openvdb/visit_grid.h"
#include "core/vdb/walk/memory_charge.h"

namespace tet {
namespace {

using Brick = std::array<std::int64_t, kBrickCells>;

absl::Status no_labels(const openvdb::GridBase& grid) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "its values are %s, and labels are whole numbers, of an int32, int64, bool "
      "or mask grid: mesh it at an iso value (--iso), or each of several level sets as a label "
      "(--all-grids)",
      grid.valueType()));
}

/// The box around active voxels, if a segmentation has a table of so many bricks.
absl::StatusOr<VoxelBox> box_of(const openvdb::GridBase& grid) {
  const openvdb::CoordBBox active = grid.evalActiveVoxelBoundingBox();
  if (active.empty()) {
    return absl::FailedPreconditionError("it is empty: no voxel is active");
  }
  std::uint64_t bricks = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = active.min()[axis], high = active.max()[axis];
    if (low < -kMaxVoxelCoord || high > kMaxVoxelCoord) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "its voxels reach from %d to %d; the limit is %d from 0", low, high, kMaxVoxelCoord));
    }
    // Each is less than 2^28, and the product of two is checked before the third.
    bricks *= static_cast<std::uint64_t>((high >> kBrickShift) - (low >> kBrickShift) + 1);
    if (bricks <= kMostLabelBricks) continue;
    return absl::ResourceExhaustedError(absl::StrFormat(
        "the box around its active voxels has more than %d bricks of 8 x 8 x 8 voxels: crop it",
        kMostLabelBricks));
  }
  return VoxelBox{{active.min().x(), active.min().y(), active.min().z()},
                  {active.max().x(), active.max().y(), active.max().z()}};
}

/// What a mask has is said by its active voxels.
template <class GridT>
constexpr bool kIsMask = std::is_same_v<GridT, openvdb::MaskGrid>;

template <class GridT>
void copy_leaf(const typename GridT::TreeType::LeafNodeType& leaf, Brick& brick) {
  for (openvdb::Index i = 0; i < kBrickCells; ++i) {
    brick[i] = static_cast<std::int64_t>(leaf.getValue(i));
  }
}

/// The voxels from `first` on.
template <class GridT>
void copy_brick(const typename GridT::ConstAccessor& values,
                const openvdb::Coord& first,
                Brick& brick) {
  if (const auto* leaf = values.probeConstLeaf(first)) {
    copy_leaf<GridT>(*leaf, brick);
  } else if constexpr (kIsMask<GridT>) {
    brick.fill(values.isValueOn(first) ? 1 : 0);
  } else {
    brick.fill(static_cast<std::int64_t>(values.getValue(first)));
  }
}

template <class GridT>
absl::StatusOr<LabelVolume> copy_bricks(const GridT& grid,
                                        const VoxelTransform& transform,
                                        const VoxelBox& box) {
  LabelVolumeBuilder builder(grid.getName(), transform, box);
  const auto values = grid.getConstAccessor();
  Brick brick;
  const auto low = [](std::int32_t voxel) { return voxel >> kBrickShift; };
  for (std::int32_t x = low(box.min.x); x <= low(box.max.x); ++x) {
    for (std::int32_t y = low(box.min.y); y <= low(box.max.y); ++y) {
      for (std::int32_t z = low(box.min.z); z <= low(box.max.z); ++z) {
        const openvdb::Coord first(x * kBrickEdge, y * kBrickEdge, z * kBrickEdge);
        copy_brick<GridT>(values, first, brick);
        if (absl::Status s = builder.add_brick({x, y, z}, brick); !s.ok()) return s;
      }
    }
  }
  return std::move(builder).build();
}

}  // namespace

absl::Status check_labels(const openvdb::GridBase& grid) {
  const bool whole = visit_whole(
      grid, [](const auto&) { return true; }, [] { return false; });
  return whole ? voxel_transform(grid.transform()).status() : no_labels(grid);
}

absl::StatusOr<LabelVolume> copy_labels(const openvdb::GridBase& grid) {
  if (absl::Status s = check_labels(grid); !s.ok()) return s;
  const absl::StatusOr<VoxelTransform> transform = voxel_transform(grid.transform());
  const absl::StatusOr<VoxelBox> box = box_of(grid);
  if (!box.ok()) return box.status();
  return visit_whole(
      grid, [&](const auto& known) { return copy_bricks(known, *transform, *box); },
      [&]() -> absl::StatusOr<LabelVolume> { return no_labels(grid); });
}

}  // namespace tet
