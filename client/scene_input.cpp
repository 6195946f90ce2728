#include "client/scene_input.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "proto/scene/scene_message.h"

namespace tet {
namespace {

absl::Status about(const std::string& path, const absl::Status& status) {
  return {status.code(), absl::StrCat(path, ": ", status.message())};
}

absl::StatusOr<std::string> read_text(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file && text << file.rdbuf()) return text.str();
  return absl::NotFoundError(absl::StrCat("cannot read ", path, ": ", std::strerror(errno)));
}

}  // namespace

bool is_scene_file(const std::string& path) {
  return absl::EndsWith(absl::AsciiStrToLower(path), ".json");
}

absl::StatusOr<::tetstream::v1::Scene> read_scene_file(const std::string& path) {
  const absl::StatusOr<std::string> text = read_text(path);
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
