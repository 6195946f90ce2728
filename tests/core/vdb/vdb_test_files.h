// Small OpenVDB grids, and the files they are written to.
#pragma once

#include <string>

#include <openvdb/tools/LevelSetSphere.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "tests/support/test_directory.h"

namespace tet::test {

inline void write_vdb(const std::string& path, const openvdb::GridCPtrVec& grids) {
  openvdb::io::File(path).write(grids);
}

/// A ball of `radius` voxels, with inside tiles when it is large enough.
inline openvdb::FloatGrid::Ptr ball(float radius,
                                    const std::string& name = "ball",
                                    const openvdb::Vec3f& centre = {0, 0, 0}) {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius, centre, 1);
  grid->setName(name);
  return grid;
}

}  // namespace tet::test
