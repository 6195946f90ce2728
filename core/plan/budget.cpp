#include "core/plan/budget.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/lattice/bcc.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/topology/surface_topology.h"

namespace tet {
namespace {

/// Memory that a surveyed brick takes until the mesh is made, bytes: it may be held twice while
/// columns grow.
constexpr std::uint64_t survey_bytes_per_brick(const StuffingRules& rules) noexcept {
  const std::uint64_t fans = rules.both_sides ? sizeof(FanMasks) : 0;
  return 2 * (sizeof(StuffedBrick) + sizeof(BrickMask) + sizeof(BrickCoord) +
              sizeof(SurfaceCounts) + sizeof(SurfaceSheet) + fans);
}

/// Memory that one takes besides where its nodes' states are kept until none has to be
/// restored.
constexpr std::uint64_t kManifoldBytesPerFoundBrick = 640;

}  // namespace

absl::Status check_inside_budget(const FoundBricks& found,
                                 int levels,
                                 const MeshLimits& limits) {
  const double leaves = std::ldexp(found.inside_cells, -3 * levels);
  const double tets = leaves * kTetShapes;
  // Bricks near the surface count as full here: thin walls are eightfold.
  if (tets > kTetSlack * static_cast<double>(limits.max_tets)) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "with levels %d the mesh would have about %.3g tets; the limit is %d. Mesh with more "
        "levels or a larger spacing",
        levels, tets, limits.max_tets));
  }
  const double bytes = leaves / kBrickCells * kBytesPerBrick;
  if (bytes <= static_cast<double>(limits.max_plan_bytes)) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "with levels %d counting the inside would take about %.3g bytes; the limit is %d. Mesh "
      "with more levels or a larger spacing",
      levels, bytes, limits.max_plan_bytes));
}

std::size_t most_surface_bricks(const StuffingRules& rules, const MeshLimits& limits) {
  return std::min<std::uint64_t>(kMaxSurfaceBricks,
                                 limits.max_plan_bytes / survey_bytes_per_brick(rules));
}

std::size_t most_found_bricks(const PhiField& field,
                              const MeshedSpace& space,
                              const MeshLimits& limits) {
  // A scene's bricks are found by their own parts, and voxels' by their values.
  if (field.scene != nullptr || field.at_voxels()) {
    return most_surface_bricks(space.rules, limits);
  }
  const std::uint64_t bytes =
      kBytesPerFoundBrick + (space.manifold ? kManifoldBytesPerFoundBrick : 0);
  return std::min<std::uint64_t>(kMaxSurfaceBricks, limits.max_plan_bytes / bytes);
}

absl::Status check_plan_budget(const FoundBricks& found, std::size_t most) {
  const std::size_t bricks = found.near_surface.size();
  if (bricks <= most) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "%d bricks of 8^3 cells lie near the surface in the box; the limit is %d, as many as the "
      "memory for counting a mesh holds. Use a larger spacing or a smaller box",
      bricks, most));
}

absl::Status check_survey_budget(std::size_t bricks,
                                 const RareBytes& beside,
                                 const MeshedSpace& space) {
  const std::size_t most = space.most_bricks;
  if (bricks > most) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "more than %d bricks of 8^3 cells lie near the surface, as many as the memory for "
        "counting a mesh holds. Use a larger spacing or a smaller box",
        most));
  }
  const std::uint64_t per_brick = survey_bytes_per_brick(space.rules);
  const std::uint64_t room = (most - bricks) * per_brick;
  if (beside.parts + beside.thin <= room) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "the surface has so many %s that counting a mesh takes more than the %d bytes that there "
      "are for it. Use a larger spacing or a smaller box%s",
      beside.parts > 0 ? "parts and thin walls" : "thin walls", most * per_brick,
      beside.thin <= room ? ", or mesh without statistics" : ""));
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
  // The mesh, without fields, and for its poor tets 1.3 times as much again on random signs,
  // where they are most. Of labels its first positions, too.
  const ChunkSizes sizes(header, whole_of(header));
  const std::uint64_t halves = header.labels.empty() ? 5 : 6;
  const std::uint64_t bytes = (sizes.total() - sizes.fields) * halves / 2;
  if (bytes <= limits.max_plan_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "improving %d vertices and %d tets would take %d bytes; the limit is %d. Use a larger "
      "spacing, or mesh without improvement",
      header.vertex_count, header.tet_count, bytes, limits.max_plan_bytes));
}

}  // namespace tet
