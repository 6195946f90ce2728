// Meshes with arrays as VTK's XML unstructured grids (.vtu).
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/files/block_writer.h"
#include "core/remap/data_mesh.h"

namespace tet {

/// Writes points as Float64 and every array in its own type, whole or not at all. Errors: those
/// of AtomicFile, kResourceExhausted (the disk is full), kCancelled.
absl::Status write_data_vtu(const std::string& path,
                            const DataMesh& mesh,
                            const WriteControl& control = {});

}  // namespace tet
