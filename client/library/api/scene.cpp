#include "tetstream/scene.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/strings/str_cat.h>

#include "client/library/api/scene_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/volume_impl.h"
#include "client/library/api/work.h"
#include "proto/scene/scene_message.h"
#include "proto/wire/sha256.h"

namespace tetstream {
namespace {

absl::Status unknown_grid(std::size_t node, const std::string& name) {
  return absl::InvalidArgumentError(absl::StrCat(
      "nodes[", node, "].grid.name \"", name,
      "\" is none of the volumes given, nor what a server stores (grids/{sha256})"));
}

/// Gives the nodes their volumes; false where a server stores some of them.
absl::StatusOr<bool> give_volumes(const std::vector<SceneGrid>& grids,
                                  tet::scene::Description& description) {
  bool all_here = true;
  for (std::size_t i = 0; i < description.nodes.size(); ++i) {
    auto* const grid = std::get_if<tet::scene::GridSolid>(&description.nodes[i].kind);
    if (grid == nullptr) continue;
    const auto given = std::ranges::find(grids, grid->file, &SceneGrid::name);
    if (given != grids.end()) {
      grid->volume = given->volume.impl().components.front();
    } else if (!tet::digest_of_name(grid->file).empty()) {
      all_here = false;
    } else {
      return unknown_grid(i, grid->file);
    }
  }
  return all_here;
}

absl::Status about_volume(const SceneGrid& grid) {
  if (grid.volume.kind() != VolumeKind::kValues) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("grid \"", grid.name, "\" has no inside: it is of VolumeKind::kValues"));
}

absl::StatusOr<Scene::Impl> read(const std::string& json, const std::vector<SceneGrid>& grids) {
  for (const SceneGrid& grid : grids) {
    if (absl::Status status = about_volume(grid); !status.ok()) return status;
  }
  auto message = tet::scene_from_json(json);
  if (!message.ok()) return message.status();
  auto description = tet::description_of_message(*message);
  if (!description.ok()) return description.status();
  const absl::StatusOr<bool> all_here = give_volumes(grids, *description);
  if (!all_here.ok()) return all_here.status();
  Scene::Impl impl{*std::move(message), grids, nullptr};
  if (!*all_here) return impl;
  absl::StatusOr<tet::Scene> scene = tet::make_scene(*description);
  if (!scene.ok()) return scene.status();
  impl.core = std::make_shared<const tet::Scene>(*std::move(scene));
  return impl;
}

/// As a server says it: `scene.nodes[2].sphere.radius ...`.
absl::Status about_scene(const absl::Status& status) {
  const bool names_node = status.message().substr(0, 6) == "nodes[";
  return {status.code(), absl::StrCat(names_node ? "scene." : "the text ", status.message())};
}

}  // namespace

Scene::Scene(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Result<Scene> Scene::from_json(const std::string& json, const std::vector<SceneGrid>& grids) {
  return guarded([&]() -> Result<Scene> {
    absl::StatusOr<Impl> impl = read(json, grids);
    if (!impl.ok()) return to_public(about_scene(impl.status()));
    return Scene(std::make_shared<const Impl>(*std::move(impl)));
  });
}

}  // namespace tetstream
