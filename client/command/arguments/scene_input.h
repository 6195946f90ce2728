// Scenes as input: JSON files, read as the messages that a server takes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/scene/scene.h"
#include "tetstream/v1/scene.pb.h"

namespace tet {

/// Whether a path ends like a scene file: .json.
bool is_scene_file(const std::string& path);

/// Reads a grid: a .vdb file's path, and the grid's name within it, which may be empty.
using ReadGrid = std::function<absl::StatusOr<Volume>(const std::string& path,
                                                      const std::string& grid_name)>;

/// A scene file, ready to mesh. Names of grids are paths, seen from the scene's own folder or
/// else from the working directory; each grid is read once. Errors: kNotFound, kInvalidArgument
/// (not a scene; says where), those of make_scene, all with the path; those of `read`.
absl::StatusOr<Scene> read_scene(const std::string& path, const ReadGrid& read);

/// The files of a scene's grids; none of a scene that cannot be read, which whoever meshes it
/// tells of.
std::vector<std::string> grid_files_of_scene(const std::string& path);

/// Hands a .vdb file over to a server: the name that it has there.
using StoreFile = std::function<absl::StatusOr<std::string>(const std::string& path)>;

/// A scene file as a message whose grids are stored: each file once. What is named as stored
/// files are is taken to be there. Errors: as those of read_scene, and of `store`.
absl::StatusOr<::tetstream::v1::Scene> read_scene_message(const std::string& path,
                                                          const StoreFile& store);

}  // namespace tet
