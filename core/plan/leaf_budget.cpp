#include "core/plan/leaf_budget.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/lattice/bcc.h"
#include "core/octree/sized_cells.h"
#include "core/octree/surface_sizes.h"
#include "core/plan/budget.h"

namespace tet {
namespace {

/// As many leaves as a sizing may ask for: somewhat more than a mesh within the limits has.
double most_leaves(const MeshLimits& limits) {
  return std::min(kTetSlack * static_cast<double>(limits.max_tets) / kTetShapes,
                  static_cast<double>(limits.max_plan_bytes) / kBytesPerBrick * kBrickCells);
}

/// Small leaves along the surface, because larger ones may only come far behind
/// it, or in its shells.
absl::Status check_layers_budget(const Sizing& sizing,
                                 const LeafRules& rules,
                                 const FoundBricks& found,
                                 const MeshLimits& limits) {
  const double area = static_cast<double>(found.near_surface.size()) * kBrickEdge * kBrickEdge;
  const auto cells_within = [&](double depth) {
    return std::min(area * depth, found.inside_cells);
  };
  const double most = most_leaves(limits);
  const bool finest_at_surface = !sizing.grade_surface;
  const double layered = finest_at_surface && rules.layers > 1 ? cells_within(rules.layers) : 0;
  if (layered > most) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "sizing.growth keeps %d layers of the finest leaves, about %.3g along this surface; "
        "there may be %.3g. Let leaves grow faster, or use a larger spacing",
        rules.layers, layered, most));
  }
  for (const auto& [level, depth] : rules.shells) {
    const double leaves = cells_within(depth) / std::ldexp(1, 3 * (level - 1));
    if (leaves <= most) continue;
    return absl::ResourceExhaustedError(absl::StrFormat(
        "a shell of sizing.regions has about %.3g leaves; there may be %.3g. Use a larger size "
        "or less depth",
        leaves, most));
  }
  return absl::OkStatus();
}

void refine_more(LeafRules& rules, const std::vector<CellSet>& more) {
  rules.refined.resize(std::max(rules.refined.size(), more.size()));
  for (std::size_t level = 0; level < more.size(); ++level) {
    unite(rules.refined[level], more[level]);
  }
}

}  // namespace

OctreeCover cover_of(const PreparedMesh& prepared) {
  return {prepared.bricks.inside, prepared.space.domain};
}

absl::StatusOr<LeafRules> leaf_rules_within(const MeshLimits& limits,
                                            const Sizing& sizing,
                                            const PreparedMesh& prepared,
                                            const Cancellation& cancellation) {
  const int levels = prepared.asked.levels;
  if (levels == 0) return LeafRules{};
  absl::StatusOr<LeafRules> rules = leaf_rules(sizing, prepared.field, cover_of(prepared),
                                               levels, most_leaves(limits), cancellation);
  if (!rules.ok()) return rules;
  if (sizing.sizes_surface()) {
    refine_more(*rules, surface_cells_to_refine(
                            sizing, prepared.field, prepared.bricks.near_surface,
                            prepared.space.domain, rules->max_levels, cancellation));
  }
  if (auto status = check_layers_budget(sizing, *rules, prepared.bricks, limits);
      !status.ok()) {
    return status;
  }
  return rules;
}

}  // namespace tet
