#include "core/vdb/openvdb/copy_grid.h"

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/vdb/openvdb/vdb_transform.h"
#include "core/vdb/openvdb/visit_grid.h"
#include "core/vdb/plain/grid_facts.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

VoxelCoord to_voxel(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }
BrickCoord to_brick(const openvdb::Coord& c) { return {c.x() >> 3, c.y() >> 3, c.z() >> 3}; }

/// One number of a value: the value itself, or a component of a vector.
struct Component {
  int index = 0;

  template <class T>
  float operator()(const T& value) const {
    if constexpr (std::is_arithmetic_v<T>) {
      return static_cast<float>(value);
    } else {
      return static_cast<float>(value[index]);
    }
  }
};

/// Copies every leaf into its place; leaves sorted as bricks are.
template <class TreeT>
void copy_leaves(const TreeT& tree, Component component, Volume& volume) {
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
        float* const to = &volume.values[i * kBrickCells];
        if constexpr (std::is_same_v<typename TreeT::ValueType, bool>) {
          for (openvdb::Index v = 0; v < kBrickCells; ++v) to[v] = leaves[i]->getValue(v);
        } else {
          const auto* from = leaves[i]->buffer().data();
          std::transform(from, from + kBrickCells, to, component);
        }
      },
      64);
}

/// Calls `visit(lowest voxel, value)` for each tile of a node that differs from the background.
template <class NodeT, class Visit>
void for_each_tile(const NodeT& node,
                   Component component,
                   float background,
                   const Visit& visit) {
  for (auto tile = node.cbeginValueAll(); tile; ++tile) {
    // A mask's tiles are in it where they are active, as its voxels are.
    constexpr bool kMask = std::is_same_v<typename NodeT::BuildType, openvdb::ValueMask>;
    const float value = kMask ? static_cast<float>(tile.isValueOn()) : component(*tile);
    if (value != background) visit(tile.getCoord(), value);
  }
}

template <class TreeT>
std::vector<ConstantBrick> copy_tiles(const TreeT& tree, Component component, Volume& volume) {
  using Upper = typename TreeT::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  static_assert(Upper::DIM == 4096 && Lower::DIM == 128 && TreeT::LeafNodeType::DIM == 8);
  const float background = volume.background;
  const auto add_cube = [&](std::int32_t edge) {
    return [&volume, edge](const openvdb::Coord& min, float value) {
      volume.cubes.push_back({to_voxel(min), edge, value});
    };
  };
  for_each_tile(tree.root(), component, background, add_cube(4096));
  std::vector<const Upper*> uppers;
  tree.getNodes(uppers);
  for (const Upper* node : uppers) for_each_tile(*node, component, background, add_cube(128));
  std::vector<const Lower*> lowers;
  tree.getNodes(lowers);
  std::vector<ConstantBrick> constants;
  for (const Lower* node : lowers) {
    for_each_tile(*node, component, background, [&](const openvdb::Coord& min, float value) {
      constants.push_back({to_brick(min), value});
    });
  }
  return constants;
}

/// All of a grid, but for what its values mean.
template <class GridT>
absl::StatusOr<Volume> copy_values(const GridT& grid, Component component, VolumeKind kind) {
  absl::StatusOr<VoxelTransform> transform = voxel_transform(grid.transform());
  if (!transform.ok()) return transform.status();
  Volume volume;
  volume.name = grid.getName();
  volume.kind = kind;
  volume.transform = *transform;
  volume.background = component(grid.background());
  if (absl::Status s = check_background(volume.background); !s.ok()) return s;
  copy_leaves(grid.tree(), component, volume);
  std::vector<ConstantBrick> constants = copy_tiles(grid.tree(), component, volume);
  return finish_volume(std::move(volume), std::move(constants));
}

template <class GridT>
absl::StatusOr<Volume> copy_scalar_grid(const GridT& grid) {
  absl::StatusOr<Volume> volume = copy_values(grid, Component{}, VolumeKind::kLevelSet);
  if (!volume.ok()) return volume;
  set_kind(openvdb::GridBase::gridClassToString(grid.getGridClass()), *volume);
  return volume;
}

template <class GridT>
absl::StatusOr<Volume> copy_component(const openvdb::GridBase& grid, std::uint32_t component) {
  constexpr bool kVector = !std::is_arithmetic_v<typename GridT::ValueType>;
  constexpr VolumeKind kKind = kVector ? VolumeKind::kVectorField : VolumeKind::kField;
  if (component >= components_of(kKind)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "its values are %s: there is no component %d", grid.valueType(), component));
  }
  return copy_values(static_cast<const GridT&>(grid), Component{static_cast<int>(component)},
                     kKind);
}

absl::Status wrong_type(const openvdb::GridBase& grid) {
  return absl::FailedPreconditionError(
      absl::StrFormat("its values are %s, and only float, double, int32, int64, bool and mask "
                      "grids can be meshed: write a level set or a density",
                      grid.valueType()));
}

bool is_scalar(const openvdb::GridBase& grid) {
  return visit_scalar(
      grid, [](const auto&) { return true; }, [] { return false; });
}

bool is_vector(const openvdb::GridBase& grid) {
  return grid.isType<openvdb::Vec3SGrid>() || grid.isType<openvdb::Vec3DGrid>();
}

}  // namespace

absl::Status check_meshable(const openvdb::GridBase& grid) {
  if (!is_scalar(grid)) return wrong_type(grid);
  return voxel_transform(grid.transform()).status();
}

absl::StatusOr<Volume> copy_grid(const openvdb::GridBase& grid) {
  return visit_scalar(
      grid, [](const auto& known) { return copy_scalar_grid(known); },
      [&]() -> absl::StatusOr<Volume> { return wrong_type(grid); });
}

absl::Status check_field(const openvdb::GridBase& grid) {
  if (is_scalar(grid) || is_vector(grid)) return voxel_transform(grid.transform()).status();
  return absl::FailedPreconditionError(absl::StrFormat(
      "its values are %s, and a field has float, double, int32, int64, bool, vec3s or vec3d",
      grid.valueType()));
}

std::uint32_t field_components(const openvdb::GridBase& grid) {
  if (!check_field(grid).ok()) return 0;
  return components_of(is_vector(grid) ? VolumeKind::kVectorField : VolumeKind::kField);
}

absl::StatusOr<Volume> copy_field(const openvdb::GridBase& grid, std::uint32_t component) {
  if (grid.isType<openvdb::Vec3SGrid>()) {
    return copy_component<openvdb::Vec3SGrid>(grid, component);
  }
  if (grid.isType<openvdb::Vec3DGrid>()) {
    return copy_component<openvdb::Vec3DGrid>(grid, component);
  }
  return visit_scalar(
      grid,
      [&](const auto& known) {
        return copy_component<std::remove_cvref_t<decltype(known)>>(grid, component);
      },
      [&]() -> absl::StatusOr<Volume> { return check_field(grid); });
}

bool has_real_values(const openvdb::GridBase& grid) {
  return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>() ||
         grid.isType<openvdb::Vec3SGrid>() || grid.isType<openvdb::Vec3DGrid>();
}

}  // namespace tet
