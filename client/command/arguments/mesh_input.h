// What commands mesh: volumes, closed surfaces and scenes, in files or stored already.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/command/arguments/surface_input.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace tet {

/// An input as the command line names it.
struct MeshInput {
  std::string path;
  std::vector<std::string> grids;  ///< of a .vdb file; empty takes its only meshable one
  SurfaceChoices surface;          ///< where it is one
};

/// Whether it can be an input, by its ending. Errors: kInvalidArgument.
absl::Status check_mesh_input(const MeshInput& input);

/// The name of the stored file that `text` is, or whose digest it is; empty for anything else.
std::string stored_grid_name(const std::string& text);

/// Who is told of an upload.
struct UploadWatch {
  std::function<void(std::uint64_t done, std::uint64_t total)> bytes;
  /// What a surface was converted to, once it was.
  std::function<void(const ConversionReport& report)> converted;
};

/// The stored file's name; not of a scene. A surface goes up as the level set it becomes here.
/// Errors: those of read_surface and surface_to_vdb, and of MeshClient::upload_file.
absl::StatusOr<std::string> upload_input(MeshClient& client,
                                         const MeshInput& input,
                                         const UploadWatch& watch,
                                         const Cancellation& cancellation);

}  // namespace tet
