// The rules once more, written as plainly as they read: no bricks, no masks, no shards. Slow,
// and sharing nothing with the mesher but the volume, so that both would have to be wrong
// alike.
#pragma once

#include <cstdint>

#include "core/volume/volume.h"

namespace tet::test {

struct ReferenceCounts {
  std::uint64_t vertices = 0, tets = 0;
};

/// Counts of the uniform mesh of a level set's `box` (which holds every inside voxel) at its
/// own voxel size, by maps over lattice nodes.
ReferenceCounts reference_counts(const Volume& volume,
                                 const VoxelBox& box,
                                 double alpha_long,
                                 double alpha_short);

}  // namespace tet::test
