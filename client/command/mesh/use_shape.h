// What a command does with a finished mesh that needs its shape once more.
#pragma once

#include <absl/status/status.h>

#include "client/command/mesh/mesh_maker.h"
#include "core/base/cancel.h"

namespace tet {

/// Adds `middles` to a made mesh: it becomes one of second order. Errors: those of
/// make_second_order, and of reading the input where a server made the mesh.
absl::Status add_middle_nodes(const MeshOptions& options,
                              MadeMesh& made,
                              ProgressBar& bar,
                              const Cancellation& interruption);

/// Adds the volumes of a segmentation's voxels to a mesh that a server made: the input is read
/// here. A report comes without where it cannot be, and a note says why. Errors: kCancelled.
absl::Status add_voxel_volumes(const MeshOptions& options,
                               MadeMesh& made,
                               ProgressBar& bar,
                               const Cancellation& interruption);

/// Adds `fidelity` to a made mesh; the input is read once more where a server made it. A report
/// comes without where it cannot be measured, and says why. Errors: kCancelled.
absl::Status check_fidelity(const MeshOptions& options,
                            MadeMesh& made,
                            ProgressBar& bar,
                            const Cancellation& interruption);

}  // namespace tet
