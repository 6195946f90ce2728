#include "bench/openvdb_surface.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <openvdb/tools/VolumeToMesh.h>

#include "core/vdb/openvdb/vdb_grids.h"

namespace tet::bench {
namespace {

openvdb::Coord first_voxel(BrickCoord b) { return {8 * b.x, 8 * b.y, 8 * b.z}; }

void add_bricks(const Volume& volume, openvdb::FloatTree& tree) {
  const float* values = volume.values.data();
  for (const BrickCoord brick : volume.bricks) {
    auto* const leaf = tree.touchLeaf(first_voxel(brick));
    for (openvdb::Index i = 0; i < kBrickCells; ++i) {
      const float value = *values++;  // OpenVDB's leaves have our bricks' order
      leaf->setValueOnly(i, value);
      leaf->setActiveState(i, std::abs(value) < volume.background);
    }
  }
}

void add_constants(const Volume& volume, openvdb::FloatTree& tree) {
  for (const ConstantCube& cube : volume.cubes) {
    const openvdb::Index level = cube.edge == 128 ? 2 : 3;
    tree.addTile(level, {cube.min.x, cube.min.y, cube.min.z}, cube.value, false);
  }
  for (const Region& region : volume.regions) {
    for (std::size_t i = 0; i < region.constant.size(); ++i) {
      if (region.brick_index[i] != Region::kConstant) continue;
      const auto at = static_cast<std::int32_t>(i);
      const BrickCoord brick{region.min.x + at / 256, region.min.y + at / 16 % 16,
                             region.min.z + at % 16};
      tree.addTile(1, first_voxel(brick), region.constant[i], false);
    }
  }
}

}  // namespace

struct OpenVdbSurface::Impl {
  openvdb::FloatGrid grid;
};

OpenVdbSurface::OpenVdbSurface(const Volume& volume)
    : impl_(std::make_unique<Impl>(Impl{openvdb::FloatGrid(volume.background)})) {
  impl_->grid.setGridClass(openvdb::GRID_LEVEL_SET);
  add_constants(volume, impl_->grid.tree());
  add_bricks(volume, impl_->grid.tree());
}

OpenVdbSurface::~OpenVdbSurface() = default;

std::uint64_t OpenVdbSurface::count_triangles() const {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(impl_->grid, points, quads);
  return 2 * quads.size();
}

}  // namespace tet::bench
