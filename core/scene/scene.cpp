#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>

#include "core/scene/check_grids.h"
#include "core/scene/check_nodes.h"
#include "core/scene/compile.h"
#include "core/scene/extent.h"

namespace tet {
namespace {

bool is_infinite(const WorldBox& box) {
  const auto any = [](const WorldPoint& p) {
    return std::isinf(p.x) || std::isinf(p.y) || std::isinf(p.z);
  };
  return box.min.x < box.max.x && (any(box.min) || any(box.max));
}

/// Parts of the last node, if it is a union: each ends where an operator of it follows.
std::vector<scene::NodeRun> solids_of_last(const scene::Description& description,
                                           const scene::Parts& parts,
                                           const std::vector<scene::Instruction>& program) {
  const auto last = static_cast<std::uint32_t>(description.nodes.size() - 1);
  auto end = static_cast<std::uint32_t>(program.size());
  const auto* combination = std::get_if<scene::Combination>(&description.nodes[last].kind);
  if (combination == nullptr || combination->how != scene::Combine::kUnion) {
    return {{last, 0, end}};
  }
  std::vector<scene::NodeRun> solids;
  for (auto part = parts[last].rbegin(); part != parts[last].rend(); ++part) {
    const bool is_first = std::next(part) == parts[last].rend();
    if (!is_first) --end;  // the operator
    const std::uint32_t begin = is_first ? 0 : program[end - 1].first;
    solids.push_back({*part, begin, end});
    end = begin;
  }
  std::ranges::reverse(solids);
  return solids;
}

/// The field that blends the parts of the last node, if it is a union that does.
std::string blending_field(const scene::Description& description) {
  const std::size_t last = description.nodes.size() - 1;
  const auto* combination = std::get_if<scene::Combination>(&description.nodes[last].kind);
  const bool blends = combination != nullptr && combination->how == scene::Combine::kUnion &&
                      combination->smoothing > 0;
  return blends ? scene::path_of(description, last) + ".smoothing" : "";
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
  if (auto status = scene::check_frames(description, program.instructions); !status.ok()) {
    return status;
  }
  Scene made;
  made.program = std::move(program.instructions);
  made.runs = std::move(program.runs);
  made.solids = solids_of_last(description, *parts, made.program);
  made.blended = blending_field(description);
  for (const scene::Node& node : description.nodes) made.node_names.push_back(node.name);
  for (auto& grid : program.grids) made.grids.emplace_back(std::move(grid));
  if (auto status = scene::check_grid_levels(description, made.program, made.grids);
      !status.ok()) {
    return status;
  }
  made.inside_guess = scene::guessed_insides(description);
  made.stack_depth = scene::deepest_stack(made.program);
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
