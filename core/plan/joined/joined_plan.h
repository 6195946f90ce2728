// The meshes of several grids as one: planned in turn, and handed out one behind the other.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/plan_job.h"

namespace tet {

/// The grids of a request, by name: what refusals of them begin with.
inline constexpr char kGridNamesField[] = "grid_names";

/// Whether such grids can be meshed together: 1 to kMaxMeshParts names, none empty and none
/// twice. OK or kInvalidArgument; the message begins with the field, as `grid_names[3]`, and
/// says its value and what it may be.
absl::Status check_grid_names(std::span<const std::string> names);

/// One grid's mesh among those of several.
struct JoinedPart {
  std::shared_ptr<const MeshPlan> plan;
  std::optional<WorldPoint> move;  ///< to the shared origin; nothing where it has that
  std::uint64_t first_chunk = 0, first_vertex = 0, first_tet = 0;
  std::uint64_t first_face = 0, first_label = 0;  ///< 0 where the mesh has no faces
};

/// Each grid has the mesh that it has alone, on its own lattice; no two are connected. A chunk
/// belongs to one grid. Thickness and suggested spacing of thin walls are the smallest of all
/// grids; topology and improvement are those of all together, and nothing where a grid has
/// none.
///
/// All positions are relative to one origin: that of the first grid's mesh. A grid whose
/// lattice is the first one's has the positions of its mesh alone with that origin. Another one
/// has those of its mesh alone with that origin and float64 coordinates, moved by what its own
/// origin, a corner of its lattice, is off, and rounded once as they are stored. Fields have
/// the values at places that are not rounded yet.
class JoinedPlan final : public MeshPlan {
 public:
  /// Parts come one behind the other, as the facts say.
  JoinedPlan(MeshFacts facts, std::vector<JoinedPart> parts);

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;

 private:
  const JoinedPart& part_of(std::uint64_t chunk) const noexcept;

  const std::vector<JoinedPart> parts_;
};

/// Plans the mesh of one grid alone.
using PlanOne =
    std::function<absl::StatusOr<std::shared_ptr<const MeshPlan>>(const PlanJob& job)>;

/// Plans the meshes of a job's grids in turn, by `plan_one`. The limits hold for all meshes
/// together; neither an earlier plan nor others' surveys are looked at. Errors: those of
/// `plan_one`, with the grid's name, and those of check_grid_names and check_features.
absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_joined(const PlanJob& job,
                                                            const PlanOne& plan_one,
                                                            const Cancellation& cancellation);

}  // namespace tet
