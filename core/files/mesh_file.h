// Mesh files: the ending chooses the format.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>

#include "core/files/block_writer.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

enum class MeshFormat : std::uint8_t { kVtu, kMsh, kVtkHdf };

/// Errors: kInvalidArgument (another ending; the message lists the three).
absl::StatusOr<MeshFormat> mesh_format_of(const std::string& path);

/// Writes world coordinates, whole or not at all.
///
/// Errors: those of mesh_format_of and AtomicFile, kResourceExhausted (the disk is full),
/// kCancelled. After an error an older file at `path` is as it was.
absl::Status write_mesh_file(const std::string& path,
                             const TetMesh& mesh,
                             const WriteControl& control = {});

}  // namespace tet
