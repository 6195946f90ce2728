#include "proto/convert/scene_request.h"

#include <string>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>

#include "core/scene/scene.h"
#include "core/volume/inside.h"
#include "proto/convert/status.h"
#include "proto/scene/scene_message.h"

namespace tet {

namespace {

/// Checks the names of the files that its grids are in.
absl::Status check_files(const v1::Scene& scene) {
  for (int i = 0; i < scene.nodes_size(); ++i) {
    if (!scene.nodes(i).has_grid()) continue;
    const absl::Status status = parse_grid_name(scene.nodes(i).grid().name()).status();
    if (status.ok()) continue;
    return absl::InvalidArgumentError(absl::StrCat("nodes[", i, "].grid.", status.message()));
  }
  return absl::OkStatus();
}

absl::Status in_scene(const absl::Status& status) {
  return within_field("scene", invalid_field(std::string(status.message())));
}

}  // namespace

absl::Status parse_scene(const v1::MeshRequest& request, MeshOrder& order) {
  absl::StatusOr<scene::Description> described = description_of_message(request.scene());
  if (!described.ok()) return in_scene(described.status());
  if (auto status = check_files(request.scene()); !status.ok()) return in_scene(status);
  order.scene = *std::move(described);
  order.scene_message = request.scene();
  order.scene_message.DiscardUnknownFields();
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const Scene>> scene_of_order(const MeshOrder& order) {
  absl::StatusOr<Scene> scene = make_scene(order.scene);
  absl::Status status = scene.status();
  if (status.ok() && !order.request.box) status = check_ends(*scene);
  if (!status.ok()) return in_scene(status);
  if (!order.request.spacing && !scene->ends()) {
    return invalid_field("spacing must be set where the scene has no end");
  }
  return std::make_shared<const Scene>(*std::move(scene));
}

void set_canonical_scene(const MeshOrder& order, v1::MeshRequest& canonical) {
  *canonical.mutable_scene() = order.scene_message;
  for (int i = 0; i < canonical.scene().nodes_size(); ++i) {
    const auto* grid =
        std::get_if<scene::GridSolid>(&order.scene.nodes[static_cast<std::size_t>(i)].kind);
    if (grid == nullptr) continue;
    v1::GridSolid& named = *canonical.mutable_scene()->mutable_nodes(i)->mutable_grid();
    named.set_grid_name(grid->volume->name);
    named.set_iso(grid->iso.value_or(default_iso(*grid->volume, grid->inside)));
    // A side that the grid has of itself is left out: the scene's id is as it was.
    const InsideSide side = inside_side(*grid->volume, grid->inside);
    if (side == own_side(*grid->volume)) {
      named.clear_inside();
    } else {
      named.set_inside(side_name(side));
    }
  }
}

}  // namespace tet
