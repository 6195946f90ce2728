#include "core/octree/refined_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/octree/domain_cells.h"

namespace tet {
namespace {

/// Refined cells within a domain: those given that it reaches into, and all that stick out of
/// it.
CellSet refined_in(const CellSet& refined, const DomainCells& domain) {
  CellSetBuilder builder;
  for (std::size_t i = 0; i < refined.bricks.size(); ++i) {
    const BrickMask cells = refined.cells[i] & domain.touched(refined.bricks[i]);
    if (cells.any()) builder.add(refined.bricks[i], cells);
  }
  // Only levels whose leaves are larger than what a domain is rounded to have any, and few
  // bricks.
  if (domain.all_whole()) return builder.take();
  for_each_brick(domain.bricks(), [&](BrickCoord brick) {
    const BrickMask sticking_out = domain.touched(brick) & ~domain.whole(brick);
    if (sticking_out.any()) builder.add(brick, sticking_out);
  });
  return builder.take();
}

/// The cells that a box reaches into.
CellSet within(CellSet cells, const DomainCells& box) {
  for (std::size_t i = 0; i < cells.bricks.size(); ++i) {
    cells.cells[i] &= box.touched(cells.bricks[i]);
  }
  drop_empty(cells);
  return cells;
}

/// Finest cells.
double longest_edge(const BrickBox& box) {
  const auto& [min, max] = box;
  return kBrickEdge *
         (std::max({1.0 * max.x - min.x, 1.0 * max.y - min.y, 1.0 * max.z - min.z}) + 1);
}

/// How far cells reach after growing, cells: a neighbour across a corner is two steps away.
double reach_of(int steps) { return std::min(1.0 * steps, 2 / std::sqrt(3.0) * (steps - 1)); }

int steps_to_reach(double cells) {
  return static_cast<int>(std::ceil(std::max(cells, std::sqrt(3.0) / 2 * cells + 1)));
}

/// Cells of the shell's level within its depth of the surface. Goes most of the way in steps of
/// larger cells, so that no shell takes many.
CellSet cells_of_shell(const CellSet& at_surface,
                       const RefinedShell& shell,
                       const BrickBox& box,
                       const Cancellation& cancellation) {
  constexpr double kMostSteps = 32;
  double left = std::min(shell.depth, longest_edge(box));
  int level = shell.level;
  while (std::ldexp(left, -level) > kMostSteps) ++level;
  CellSet cells = at_surface;
  for (int l = 0; l < level; ++l) cells = parents_of(cells, cancellation);
  for (; level > shell.level && !cancellation.requested(); --level) {
    const int steps = static_cast<int>(std::ldexp(left, -level)) - 1;
    cells = within(grown(std::move(cells), steps, cancellation), DomainCells(box, level));
    left -= std::ldexp(reach_of(steps), level);
    cells = children_of(cells, cancellation);
  }
  const int steps = steps_to_reach(std::ldexp(left, -level));
  return within(grown(std::move(cells), steps, cancellation), DomainCells(box, level));
}

}  // namespace

RefinedCells::RefinedCells(const CellSet& at_surface,
                           const OctreeCover& cover,
                           const LeafRules& rules,
                           const Cancellation& cancellation)
    : cover_(cover), rules_(rules), cancellation_(cancellation) {
  if (rules.shells.empty() || cover.boxes.empty()) return;
  const BrickBox box = box_around(cover.boxes);
  for (const RefinedShell& shell : rules.shells) {
    const auto level = static_cast<std::size_t>(shell.level);
    of_shells_.resize(std::max(of_shells_.size(), level + 1));
    unite(of_shells_[level], cells_of_shell(at_surface, shell, box, cancellation));
  }
}

CellSet RefinedCells::layered(const CellSet& cells) const {
  return grown(cells, rules_.layers - 1, cancellation_);
}

CellSet RefinedCells::with_demanded(CellSet refined, int level) const {
  const auto at = static_cast<std::size_t>(level);
  if (at < rules_.refined.size()) unite(refined, rules_.refined[at]);
  if (at < of_shells_.size()) unite(refined, of_shells_[at]);
  if (cover_.domain) return refined_in(refined, DomainCells(*cover_.domain, level));
  return refined;
}

CellSet RefinedCells::first(const CellSet& at_surface) const {
  if (!rules_.sized()) return parents_of(at_surface, cancellation_);
  return with_demanded(
      parents_of(rules_.layers > 1 ? layered(at_surface) : at_surface, cancellation_), 1);
}

CellSet RefinedCells::above(const CellSet& refined, int level) const {
  return with_demanded(
      parents_with_neighbours(rules_.layers > 1 ? layered(refined) : refined, cancellation_),
      level + 1);
}

}  // namespace tet
