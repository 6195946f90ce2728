#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <absl/strings/str_cat.h>

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

}  // namespace

absl::StatusOr<Scene> make_scene(const scene::Description& description) {
  if (auto status = scene::check_sizes(description); !status.ok()) return status;
  const absl::StatusOr<scene::Parts> parts = scene::find_parts(description);
  if (!parts.ok()) return parts.status();
  absl::StatusOr<std::vector<scene::Instruction>> program = scene::compile(description, *parts);
  if (!program.ok()) return program.status();
  Scene made;
  made.program = *std::move(program);
  made.stack_depth = deepest_stack(made.program);
  made.extent = scene::extent_of(made.program);
  if (is_infinite(made.extent)) {
    made.endless = scene::path_of(description, scene::endless_node(made.program));
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
