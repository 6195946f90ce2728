// Scenes as input: JSON files, read as the messages that a server takes.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "core/scene/scene.h"
#include "tetstream/v1/scene.pb.h"

namespace tet {

/// Whether a path ends like a scene file: .json.
bool is_scene_file(const std::string& path);

/// A scene file's message. Errors: kNotFound, kInvalidArgument (not a scene; says where), both
/// with the path.
absl::StatusOr<::tetstream::v1::Scene> read_scene_file(const std::string& path);

/// The same, ready to mesh. Errors also: those of make_scene, with the path.
absl::StatusOr<Scene> read_scene(const std::string& path);

}  // namespace tet
