#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>

#include "core/scene/check_grids.h"
#include "core/scene/check_nodes.h"
#include "core/scene/compile.h"
#include "core/scene/extent.h"

namespace tet {
namespace {

std::size_t deepest_stack(const std::vector<scene::Instruction>& program) {
  std::size_t depth = 0, deepest = 0;
  for (const scene::Instruction& op : program) {
    if (is_leaf(op.op)) deepest = std::max(deepest, ++depth);
    if (is_binary(op.op)) --depth;
  }
  return deepest;
}

bool is_infinite(const WorldBox& box) {
  const auto any = [](const WorldPoint& p) {
    return std::isinf(p.x) || std::isinf(p.y) || std::isinf(p.z);
  };
  return box.min.x < box.max.x && (any(box.min) || any(box.max));
}

absl::StatusOr<scene::Parts> checked_parts(const scene::Description& description) {
  if (auto status = scene::check_sizes(description); !status.ok()) return status;
  absl::StatusOr<scene::Parts> parts = scene::find_parts(description);
  if (!parts.ok()) return parts.status();
  if (auto status = scene::check_grid_count(description); !status.ok()) return status;
  if (auto status = scene::check_instructions(description, *parts); !status.ok()) return status;
  return parts;
}

}  // namespace

std::vector<scene::GridSolid*> scene::Description::grids() {
  std::vector<GridSolid*> found;
  for (Node& node : nodes) {
    if (auto* grid = std::get_if<GridSolid>(&node.kind)) found.push_back(grid);
  }
  return found;
}

bool scene::Description::has_grids() const {
  return std::any_of(nodes.begin(), nodes.end(), [](const Node& node) {
    return std::holds_alternative<GridSolid>(node.kind);
  });
}

absl::Status check_scene(const scene::Description& description) {
  return checked_parts(description).status();
}

absl::StatusOr<Scene> make_scene(const scene::Description& description) {
  const absl::StatusOr<scene::Parts> parts = checked_parts(description);
  if (!parts.ok()) return parts.status();
  if (auto status = scene::check_loaded(description); !status.ok()) return status;
  if (auto status = scene::check_insides(description); !status.ok()) return status;
  scene::Program program = scene::compile(description, *parts);
  Scene made;
  made.program = std::move(program.instructions);
  made.runs = std::move(program.runs);
  for (const scene::Node& node : description.nodes) made.node_names.push_back(node.name);
  for (auto& grid : program.grids) made.grids.emplace_back(std::move(grid));
  if (auto status = scene::check_grid_levels(description, made.program, made.grids);
      !status.ok()) {
    return status;
  }
  made.inside_guess = scene::guessed_insides(description);
  made.stack_depth = deepest_stack(made.program);
  made.extent = scene::extent_of(made.program, made.grids);
  if (is_infinite(made.extent)) {
    made.endless = scene::path_of(description, scene::endless_node(made.program, made.grids));
  }
  return made;
}

absl::Status check_ends(const Scene& scene) {
  if (scene.ends()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(scene.endless,
                   " has no end, and nothing ends the scene: take its intersection with "
                   "something that ends, or mesh both sides within a box"));
}

}  // namespace tet
