#include "core/vdb/openvdb/write_volume.h"

#include <algorithm>
#include <cstddef>
#include <exception>

#include <absl/strings/str_cat.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/openvdb/vdb_transform.h"
#include "core/vdb/openvdb/write_vdb.h"

namespace tet {
namespace {

using openvdb::FloatGrid;
using openvdb::FloatTree;
using LeafNode = FloatTree::LeafNodeType;

static_assert(LeafNode::SIZE == kBrickCells && LeafNode::DIM == kBrickEdge);

// OpenVDB's levels of the nodes whose tiles are of 8, 128 and 4096 voxels.
constexpr openvdb::Index kBrickTile = 1, kRegionTile = 2, kCubeTile = 3;

openvdb::Coord lowest_voxel(const BrickCoord& brick) {
  return {brick.x * kBrickEdge, brick.y * kBrickEdge, brick.z * kBrickEdge};
}

bool is_upright(const VoxelTransform& transform) {
  const auto& a = transform.linear;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i][j] != (i == j ? transform.voxel_size : 0)) return false;
    }
  }
  return true;
}

openvdb::math::Transform::Ptr transform_of(const VoxelTransform& transform) {
  const auto& a = transform.linear;
  const auto& t = transform.translation;
  if (is_upright(transform)) return uniform_transform(transform.voxel_size, {t[0], t[1], t[2]});
  // OpenVDB's vectors are rows.
  const openvdb::Mat4d matrix(a[0][0], a[1][0], a[2][0], 0.0,  //
                              a[0][1], a[1][1], a[2][1], 0.0,  //
                              a[0][2], a[1][2], a[2][2], 0.0,  //
                              t[0], t[1], t[2], 1.0);
  return openvdb::math::Transform::createLinearTransform(matrix);
}

/// A guess does not become what a file says.
openvdb::GridClass class_of(const Volume& volume) {
  const bool is_guess =
      volume.kind_source == KindSource::kValues || volume.kind_source == KindSource::kNobody;
  if (is_guess) return openvdb::GRID_UNKNOWN;
  switch (volume.kind) {
    case VolumeKind::kLevelSet:
      return openvdb::GRID_LEVEL_SET;
    case VolumeKind::kFogVolume:
      return openvdb::GRID_FOG_VOLUME;
    default:
      return openvdb::GRID_UNKNOWN;
  }
}

void add_bricks(const Volume& volume, FloatTree& tree) {
  for (std::size_t i = 0; i < volume.bricks.size(); ++i) {
    LeafNode& leaf = *tree.touchLeaf(lowest_voxel(volume.bricks[i]));
    std::copy_n(volume.values.data() + i * kBrickCells, kBrickCells, leaf.buffer().data());
    leaf.setValuesOn();
  }
}

/// Bricks of one value; those of the background are there already.
void add_constant_bricks(const Region& region, float background, FloatTree& tree) {
  constexpr std::int32_t kEdge = Region::kEdgeBricks;
  for (std::int32_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (region.brick_index[at] != Region::kConstant) continue;
    if (region.constant[at] == background) continue;
    const BrickCoord brick{region.min.x + i / (kEdge * kEdge), region.min.y + i / kEdge % kEdge,
                           region.min.z + i % kEdge};
    tree.addTile(kBrickTile, lowest_voxel(brick), region.constant[at], /*active=*/false);
  }
}

void add_cube(const ConstantCube& cube, FloatTree& tree) {
  const auto level = cube.edge == kLargestCube ? kCubeTile : kRegionTile;
  tree.addTile(level, {cube.min.x, cube.min.y, cube.min.z}, cube.value, /*active=*/false);
}

FloatGrid::Ptr grid_of(const Volume& volume) {
  openvdb::initialize();
  const auto grid = FloatGrid::create(volume.background);
  FloatTree& tree = grid->tree();
  for (const ConstantCube& cube : volume.cubes) add_cube(cube, tree);
  for (const Region& region : volume.regions) {
    add_constant_bricks(region, volume.background, tree);
  }
  add_bricks(volume, tree);
  grid->setTransform(transform_of(volume.transform));
  grid->setGridClass(class_of(volume));
  grid->setName(volume.name);
  return grid;
}

}  // namespace

absl::Status write_volume(const Volume& volume, const std::string& path) {
  try {
    return write_vdb(grid_of(volume), path);
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("the volume could not be written: ", error.what()));
  }
}

}  // namespace tet
