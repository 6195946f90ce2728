#include "core/scene/solids.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/scene/compile.h"
#include "core/scene/extent.h"

namespace tet {
namespace {

Scene solid_of(const Scene& scene, const scene::NodeRun& run) {
  Scene solid;
  std::vector<std::uint32_t> kept;  // grids of the scene, by the solid's numbers
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    scene::Instruction op = scene.program[i];
    op.first -= run.begin;
    if (op.op == scene::Op::kGrid) {
      const auto known = std::ranges::find(kept, op.grid);
      const auto number = static_cast<std::uint32_t>(known - kept.begin());
      if (known == kept.end()) kept.push_back(op.grid);
      op.grid = number;
    }
    solid.program.push_back(op);
  }
  for (const std::uint32_t grid : kept) solid.grids.push_back(scene.grids[grid]);
  solid.stack_depth = scene::deepest_stack(solid.program);
  solid.extent = scene::extent_of(solid.program, solid.grids);
  solid.endless = scene.endless;
  return solid;
}

}  // namespace

std::vector<std::shared_ptr<const Scene>> solids_of(const Scene& scene) {
  std::vector<std::shared_ptr<const Scene>> solids;
  for (const scene::NodeRun& run : scene.solids) {
    solids.push_back(std::make_shared<const Scene>(solid_of(scene, run)));
  }
  return solids;
}

std::vector<std::string> names_of_solids(const Scene& scene) {
  std::vector<std::string> names;
  for (const scene::NodeRun& run : scene.solids) names.push_back(scene.node_names[run.node]);
  return names;
}

}  // namespace tet
