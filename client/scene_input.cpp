#include "client/scene_input.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>

#include "client/text_file.h"
#include "proto/scene/scene_message.h"

namespace tet {

bool is_scene_file(const std::string& path) {
  return absl::EndsWith(absl::AsciiStrToLower(path), ".json");
}

absl::StatusOr<::tetstream::v1::Scene> read_scene_file(const std::string& path) {
  const absl::StatusOr<std::string> text = read_text_file(path);
  if (!text.ok()) return text.status();
  absl::StatusOr<::tetstream::v1::Scene> message = scene_from_json(*text);
  if (!message.ok()) return about(path, message.status());
  return message;
}

absl::StatusOr<Scene> read_scene(const std::string& path) {
  const auto message = read_scene_file(path);
  if (!message.ok()) return message.status();
  absl::StatusOr<Scene> scene = scene_of_message(*message);
  if (!scene.ok()) return about(path, scene.status());
  return scene;
}

}  // namespace tet
