#include "client/command/arguments/scene_input.h"

#include <filesystem>
#include <map>
#include <memory>
#include <utility>
#include <variant>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "client/command/arguments/volume_file.h"
#include "client/command/process/interruption.h"
#include "client/library/text_file.h"
#include "proto/scene/scene_message.h"
#include "proto/wire/sha256.h"

namespace tet {
namespace {

namespace v1 = ::tetstream::v1;

absl::StatusOr<v1::Scene> read_message(const std::string& path) {
  const absl::StatusOr<std::string> text = read_text_file(path, user_interruption());
  if (!text.ok()) return text.status();
  absl::StatusOr<v1::Scene> message = scene_from_json(*text);
  if (!message.ok()) return about(path, message.status());
  return message;
}

/// Where the file of a scene's grid is.
std::string path_of_grid(const std::string& scene, const std::string& name) {
  const std::filesystem::path beside = std::filesystem::path(scene).parent_path() / name;
  std::error_code ignored;
  return std::filesystem::exists(beside, ignored) ? beside.string() : name;
}

/// Checks the name of the grid in node `node` of a scene file.
absl::Status check_name(const std::string& scene, int node, const std::string& name) {
  if (is_volume_file(name)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(scene, ": nodes[", node, "].grid.name \"", name,
                   "\" is no .vdb file and no image: `tetstream convert` makes one of a "
                   "surface, and what is stored as "
                   "grids/... is for --server"));
}

absl::Status load_grids(const std::string& path,
                        const ReadGrid& read,
                        scene::Description& description) {
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const Volume>> loaded;
  int node = -1;
  for (scene::Node& any : description.nodes) {
    ++node;
    auto* grid = std::get_if<scene::GridSolid>(&any.kind);
    if (grid == nullptr) continue;
    if (auto status = check_name(path, node, grid->file); !status.ok()) return status;
    std::shared_ptr<const Volume>& volume = loaded[{grid->file, grid->name}];
    if (volume == nullptr) {
      absl::StatusOr<Volume> found = read(path_of_grid(path, grid->file), grid->name);
      if (!found.ok()) return found.status();
      volume = std::make_shared<const Volume>(*std::move(found));
    }
    grid->volume = volume;
  }
  return absl::OkStatus();
}

absl::Status store_grids(const std::string& path, const StoreFile& store, v1::Scene& scene) {
  std::map<std::string, std::string> stored;  // by the scene's own names
  for (int i = 0; i < scene.nodes_size(); ++i) {
    if (!scene.nodes(i).has_grid()) continue;
    v1::GridSolid& grid = *scene.mutable_nodes(i)->mutable_grid();
    if (!digest_of_name(grid.name()).empty()) continue;
    if (auto status = check_name(path, i, grid.name()); !status.ok()) return status;
    std::string& name = stored[grid.name()];
    if (name.empty()) {
      absl::StatusOr<std::string> given = store(path_of_grid(path, grid.name()));
      if (!given.ok()) return given.status();
      name = *std::move(given);
    }
    grid.set_name(name);
  }
  return absl::OkStatus();
}

}  // namespace

bool is_scene_file(const std::string& path) {
  return absl::EndsWith(absl::AsciiStrToLower(path), ".json");
}

absl::StatusOr<Scene> read_scene(const std::string& path, const ReadGrid& read) {
  const auto message = read_message(path);
  if (!message.ok()) return message.status();
  absl::StatusOr<scene::Description> description = description_of_message(*message);
  if (!description.ok()) return about(path, description.status());
  if (auto status = load_grids(path, read, *description); !status.ok()) return status;
  absl::StatusOr<Scene> scene = make_scene(*description);
  if (!scene.ok()) return about(path, scene.status());
  return scene;
}

std::vector<std::string> grid_files_of_scene(const std::string& path) {
  std::vector<std::string> files;
  const absl::StatusOr<v1::Scene> message = read_message(path);
  if (!message.ok()) return files;
  for (const v1::SceneNode& node : message->nodes()) {
    if (node.has_grid()) files.push_back(path_of_grid(path, node.grid().name()));
  }
  return files;
}

absl::StatusOr<v1::Scene> read_scene_message(const std::string& path, const StoreFile& store) {
  absl::StatusOr<v1::Scene> message = read_message(path);
  if (!message.ok()) return message.status();
  // The scene is checked before its grids are stored: it may be refused.
  if (auto status = description_of_message(*message).status(); !status.ok()) {
    return about(path, status);
  }
  if (auto status = store_grids(path, store, *message); !status.ok()) return status;
  return message;
}

}  // namespace tet
