#include "core/vdb/walk/plain_choice.h"

#include <algorithm>

namespace tet {
namespace {

bool is_plain(const GridOutline& grid) {
  const bool real =
      grid.tree_type == "Tree_float_5_4_3" || grid.tree_type == "Tree_double_5_4_3";
  return real && grid.map && !grid.instance && grid.depth == WalkDepth::kValues;
}

}  // namespace

std::optional<std::size_t> find_plain_grid(const VdbOutline& outline,
                                           const std::string& grid_name,
                                           GridUse use,
                                           std::uint32_t component) {
  if (use == GridUse::kLabels || component != 0) return std::nullopt;
  const auto& grids = outline.grids;
  std::size_t found = 0;
  if (grid_name.empty()) {
    if (grids.size() != 1) return std::nullopt;
  } else {
    found = static_cast<std::size_t>(std::ranges::find(grids, grid_name, &GridOutline::name) -
                                     grids.begin());
  }
  if (found == grids.size() || !is_plain(grids[found])) return std::nullopt;
  return found;
}

bool are_plain_grids(const VdbOutline& outline) {
  return std::ranges::all_of(outline.grids, is_plain);
}

}  // namespace tet
