#include "core/grid/copy_grid.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/grid/vdb_transform.h"
#include "core/grid/volume_builder.h"

namespace tet {
namespace {

VoxelCoord to_voxel(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }
BrickCoord to_brick(const openvdb::Coord& c) { return {c.x() >> 3, c.y() >> 3, c.z() >> 3}; }

/// Copies every leaf into its place; leaves sorted as bricks are.
template <class TreeT>
void copy_leaves(const TreeT& tree, Volume& volume) {
  std::vector<const typename TreeT::LeafNodeType*> leaves;
  leaves.reserve(tree.leafCount());
  tree.getNodes(leaves);
  std::sort(leaves.begin(), leaves.end(), [](const auto* a, const auto* b) {
    return to_brick(a->origin()) < to_brick(b->origin());
  });
  volume.bricks.resize(leaves.size());
  volume.values.resize(leaves.size() * kBrickCells);
  for_each_index(
      leaves.size(),
      [&](std::size_t i) {
        volume.bricks[i] = to_brick(leaves[i]->origin());
        const auto* from = leaves[i]->buffer().data();
        std::transform(from, from + kBrickCells, &volume.values[i * kBrickCells],
                       [](auto value) { return static_cast<float>(value); });
      },
      64);
}

/// Calls `visit(lowest voxel, value)` for each tile of a node that differs from the background.
template <class NodeT, class Visit>
void for_each_tile(const NodeT& node, float background, const Visit& visit) {
  for (auto tile = node.cbeginValueAll(); tile; ++tile) {
    const auto value = static_cast<float>(*tile);
    if (value != background) visit(tile.getCoord(), value);
  }
}

template <class TreeT>
std::vector<ConstantBrick> copy_tiles(const TreeT& tree, Volume& volume) {
  using Upper = typename TreeT::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  static_assert(Upper::DIM == 4096 && Lower::DIM == 128 && TreeT::LeafNodeType::DIM == 8);
  const float background = volume.background;
  const auto add_cube = [&](std::int32_t edge) {
    return [&volume, edge](const openvdb::Coord& min, float value) {
      volume.cubes.push_back({to_voxel(min), edge, value});
    };
  };
  for_each_tile(tree.root(), background, add_cube(4096));
  std::vector<const Upper*> uppers;
  tree.getNodes(uppers);
  for (const Upper* node : uppers) for_each_tile(*node, background, add_cube(128));
  std::vector<const Lower*> lowers;
  tree.getNodes(lowers);
  std::vector<ConstantBrick> constants;
  for (const Lower* node : lowers) {
    for_each_tile(*node, background, [&](const openvdb::Coord& min, float value) {
      constants.push_back({to_brick(min), value});
    });
  }
  return constants;
}

bool any_negative(const Volume& volume) {
  const auto below_zero = [](const auto& item) { return item.value < 0; };
  return volume.background < 0 ||
         std::any_of(volume.ranges.begin(), volume.ranges.end(),
                     [](const ValueRange& range) { return range.min < 0; }) ||
         std::any_of(volume.cubes.begin(), volume.cubes.end(), below_zero) ||
         std::any_of(volume.regions.begin(), volume.regions.end(), [](const Region& region) {
           return *std::min_element(region.constant.begin(), region.constant.end()) < 0;
         });
}

VolumeKind kind_of(openvdb::GridClass grid_class, const Volume& volume) {
  if (grid_class == openvdb::GRID_LEVEL_SET) return VolumeKind::kLevelSet;
  if (grid_class == openvdb::GRID_FOG_VOLUME) return VolumeKind::kFogVolume;
  return any_negative(volume) ? VolumeKind::kLevelSet : VolumeKind::kFogVolume;
}

template <class GridT>
absl::StatusOr<Volume> copy_scalar_grid(const GridT& grid) {
  absl::StatusOr<VoxelTransform> transform = voxel_transform(grid.transform());
  if (!transform.ok()) return transform.status();
  Volume volume;
  volume.name = grid.getName();
  volume.transform = *transform;
  volume.background = static_cast<float>(grid.background());
  copy_leaves(grid.tree(), volume);
  std::vector<ConstantBrick> constants = copy_tiles(grid.tree(), volume);
  if (volume.bricks.empty() && volume.cubes.empty() && constants.empty()) {
    return absl::FailedPreconditionError(
        "it is empty: every voxel has the background value; check what wrote it");
  }
  absl::StatusOr<Volume> indexed = index_volume(std::move(volume), std::move(constants));
  if (indexed.ok()) indexed->kind = kind_of(grid.getGridClass(), *indexed);
  return indexed;
}

absl::Status wrong_type(const openvdb::GridBase& grid) {
  return absl::FailedPreconditionError(
      absl::StrFormat("its values are %s, and only float and double grids can be meshed: write "
                      "a level set or a "
                      "density",
                      grid.valueType()));
}

}  // namespace

absl::Status check_meshable(const openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>() && !grid.isType<openvdb::DoubleGrid>()) {
    return wrong_type(grid);
  }
  return voxel_transform(grid.transform()).status();
}

absl::StatusOr<Volume> copy_grid(const openvdb::GridBase& grid) {
  if (grid.isType<openvdb::FloatGrid>()) {
    return copy_scalar_grid(static_cast<const openvdb::FloatGrid&>(grid));
  }
  if (grid.isType<openvdb::DoubleGrid>()) {
    return copy_scalar_grid(static_cast<const openvdb::DoubleGrid&>(grid));
  }
  return wrong_type(grid);
}

}  // namespace tet
