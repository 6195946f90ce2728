#include "core/scene/grid_scene.h"

#include <utility>

#include "core/scene/compile.h"
#include "core/scene/extent.h"

namespace tet {

Scene scene_of_grid(const std::shared_ptr<const Volume>& volume, float iso, InsideSide inside) {
  scene::Description description;
  description.nodes.push_back(
      {"", scene::GridSolid{
               .file = {}, .name = {}, .iso = iso, .volume = volume, .inside = inside}});
  scene::Program program = scene::compile(description, scene::Parts(1));
  Scene made;
  made.program = std::move(program.instructions);
  for (auto& grid : program.grids) made.grids.emplace_back(std::move(grid));
  made.stack_depth = 1;
  made.extent = scene::extent_of(made.program, made.grids);
  return made;
}

}  // namespace tet
