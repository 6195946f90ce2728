#include "core/pipeline/budget.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/lattice/bcc.h"
#include "core/pipeline/survey.h"

namespace tet {

absl::Status check_uniform_budget(const FoundBricks& found, const MeshLimits& limits) {
  const double tets = found.inside_cells * kTetShapes;
  // Bricks near the surface count as full here, so the estimate is high: thin walls up to
  // eightfold.
  constexpr double kSlack = 8;
  if (tets <= kSlack * static_cast<double>(limits.max_tets)) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("the uniform mesh would have about %.3g tets; the limit is %d. Mesh with "
                      "interior grading (levels above 0) or a larger spacing",
                      tets, limits.max_tets));
}

absl::Status check_plan_budget(const FoundBricks& found,
                               const StuffingRules& rules,
                               const MeshLimits& limits) {
  const std::uint64_t bricks = found.near_surface.size();
  const std::uint64_t bytes = bricks * survey_bytes_per_brick(rules);
  if (bytes <= limits.max_plan_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "%d bricks of 8^3 cells lie near the surface, and counting them would take %d bytes; the "
      "limit is %d. Use a larger spacing",
      bricks, bytes, limits.max_plan_bytes));
}

absl::Status check_domain_budget(const BrickBox& domain, int levels, const MeshLimits& limits) {
  double leaves = 1;
  for (const auto& [min, max] :
       {std::pair(domain.min.x, domain.max.x), std::pair(domain.min.y, domain.max.y),
        std::pair(domain.min.z, domain.max.z)}) {
    leaves *= std::ldexp(8.0 * (max - min + 1), -levels);
  }
  // Smaller leaves only add to the tets of these.
  const double tets = leaves * kTetShapes;
  if (tets <= static_cast<double>(limits.max_tets)) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "the mesh of the box would have at least %.3g tets; the limit is %d. Use more levels, a "
      "smaller box or a larger spacing",
      tets, limits.max_tets));
}

absl::Status check_improvement_budget(const MeshHeader& header, const MeshLimits& limits) {
  // The mesh, and for its poor tets 1.3 times as much again on random signs, where they are
  // most.
  const std::uint64_t bytes =
      ChunkSizes(header, header.vertex_count, header.tet_count).total() * 5 / 2;
  if (bytes <= limits.max_plan_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "improving %d vertices and %d tets would take %d bytes; the limit is %d. Use a larger "
      "spacing, or mesh without improvement",
      header.vertex_count, header.tet_count, bytes, limits.max_plan_bytes));
}

}  // namespace tet
