// Meshes to files, or whatever else a format writes: two files, or a folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/files/mesh_formats.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Where a mesh goes, and as what.
struct MeshOutput {
  std::string path;
  MeshFormat format = MeshFormat::kVtu;
};

/// The format is the one named, or where the name is empty the one that the path's ending
/// chooses. Errors: those of mesh_format_named and mesh_format_of.
absl::StatusOr<MeshOutput> mesh_output(const std::string& path, std::string_view format = "");

/// Whether it could be written now: says so before hours of work, not after.
absl::Status check_can_write(const MeshOutput& output);

/// The paths of the files that the format has, of which readers begin with the first one; or of
/// the folder. Errors: kInvalidArgument (a name that such files cannot have).
absl::StatusOr<std::vector<std::string>> files_of(const MeshOutput& output);

/// OK, or kInvalidArgument where the format has no place for meshes of second order; the
/// message lists those that have.
absl::Status check_takes_second_order(const MeshOutput& output);

/// Writes world coordinates, whole or not at all: also where a format has two files, of which
/// the one that readers begin with comes last.
///
/// Errors: those of AtomicFile, kFailedPrecondition (a format that cannot count so far),
/// kResourceExhausted (the disk is full), kCancelled. After an error what was there before is
/// as it was. Also those of check_takes_second_order.
absl::Status write_mesh_file(const MeshOutput& output,
                             const FileMesh& mesh,
                             const WriteControl& control = {});

/// A mesh of first order. The path's ending chooses the format. Errors: also those of
/// mesh_format_of.
absl::Status write_mesh_file(const std::string& path,
                             const TetMesh& mesh,
                             const WriteControl& control = {});

/// For people: each name of the mesh that the format has to call otherwise, and how.
std::vector<std::string> changed_names(MeshFormat format, const MeshHeader& mesh);

}  // namespace tet
