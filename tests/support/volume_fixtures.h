// Volumes made from a function, without OpenVDB: what the mesher's tests mesh.
#pragma once

#include <functional>

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet::test {

/// The value of each voxel, in the units that the volume stores.
using VoxelFunction = std::function<float(VoxelCoord)>;

/// A level set of `value` in `box`, background elsewhere; every brick that meets the box has
/// values of its own. Aborts when a value is not finite.
Volume dense_volume(const VoxelBox& box,
                    float background,
                    const VoxelFunction& value,
                    const VoxelTransform& transform = {});

/// Makes the volume as OpenVDB would store it: values cut to [-background, background], and
/// bricks that are +background or -background throughout left out or kept as constants.
/// Constant bricks that fill an aligned 128-voxel cube become one cube.
Volume narrow_band_volume(const VoxelBox& box,
                          float background,
                          const VoxelFunction& value,
                          const VoxelTransform& transform = {});

/// `transform` of voxels `voxel_size` wide, neither turned nor moved.
VoxelTransform scaled(double voxel_size);

}  // namespace tet::test
