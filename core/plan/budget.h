// Refusals of meshes that would not fit, before anything is allocated for them.
#pragma once

#include <cstddef>
#include <cstdint>

#include <absl/status/status.h>

#include "core/field/find_bricks.h"
#include "core/field/phi_field.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/meshed_space.h"
#include "core/stuffing/stuffing_rules.h"

namespace tet {

/// Estimates of tets are high by up to so much.
inline constexpr double kTetSlack = 8;
/// Memory that an octree's brick takes with its nodes and counts, bytes.
inline constexpr double kBytesPerBrick = 400;
/// Memory that a brick takes until it is surveyed, bytes: lists of them are held twice while
/// they grow and while they are sorted, and graded surfaces keep another with a mask of cells.
inline constexpr std::uint64_t kBytesPerFoundBrick = 128;

/// Bricks near the surface that can be kept while the mesh is counted.
std::size_t most_surface_bricks(const StuffingRules& rules, const MeshLimits& limits);

/// Bricks that may be found for the survey to look at. Away from the voxels' own lattice most
/// of them turn out to have no part in the surface, and nothing is kept of those.
std::size_t most_found_bricks(const PhiField& field,
                              const MeshedSpace& space,
                              const MeshLimits& limits);

// Each is OK or kResourceExhausted, with the value and the limit.

/// A domain that even its coarsest leaves would fill with too many tets.
absl::Status check_domain_budget(const BrickBox& domain, int levels, const MeshLimits& limits);

/// A mesh whose inside would have too many tets even if all its leaves were as large as
/// `levels` lets them be, or too many bricks to count them in.
absl::Status check_inside_budget(const FoundBricks& found,
                                 int levels,
                                 const MeshLimits& limits);

/// A surface for which there are more than `most` bricks to look at.
absl::Status check_plan_budget(const FoundBricks& found, std::size_t most);

/// What a survey keeps beside its bricks, bytes.
struct RareBytes {
  std::uint64_t parts = 0;  ///< of the surface; none where statistics are skipped
  std::uint64_t thin = 0;   ///< walls
};

/// A survey that found more to keep than the space lets it: more bricks, which only this tells
/// where the lattice is not the voxels' own; or, beside them, so many parts of the surface and
/// thin walls that they take as much as the rest of the bricks would.
absl::Status check_survey_budget(std::size_t bricks,
                                 const RareBytes& beside,
                                 const MeshedSpace& space);

/// An improvement for which the mesh could not be kept.
absl::Status check_improvement_budget(const MeshHeader& header, const MeshLimits& limits);

}  // namespace tet
