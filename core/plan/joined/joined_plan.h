// The meshes of several grids as one: planned in turn, and handed out one behind the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/mesh_plan.h"

namespace tet {

/// The grids of a request, by name: what refusals of them begin with.
inline constexpr char kGridNamesField[] = "grid_names";

/// Whether such grids can be meshed together: 1 to kMaxMeshParts names, none empty and none
/// twice. OK or kInvalidArgument; the message begins with the field, as `grid_names[3]`, and
/// says its value and what it may be.
absl::Status check_grid_names(std::span<const std::string> names);

/// Each grid has the mesh that it has alone, on its own lattice; no two are connected.
///
/// All positions are relative to one origin: that of the first grid's mesh. A grid whose
/// lattice is the first one's has the positions of its mesh alone with that origin. Of another
/// one they are those of its mesh alone with that origin and float64 coordinates, moved by what
/// its own origin, a corner of its lattice, is off, and rounded once as they are stored.
///
/// Immutable: any thread may call any member.
class JoinedPlan {
 public:
  /// Parallel; run it on a TaskPool. The limits hold for all meshes together. Errors: those of
  /// plan_mesh, with the grid's name, and those of check_grid_names and check_features.
  static absl::StatusOr<JoinedPlan> of(const GridList& grids,
                                       const MeshRequest& request,
                                       const MeshLimits& limits,
                                       const Cancellation& cancellation,
                                       MeshProgress* progress);

  const MeshHeader& header() const noexcept { return header_; }
  /// Of all grids; the thickness and the suggested spacing are the smallest.
  ThinWalls thin_walls() const;
  /// Of all together. Nothing where a grid has none.
  std::optional<BoundaryTopology> boundary() const;
  std::optional<Improvement> improvement() const;

  /// A chunk belongs to one grid.
  ChunkExtent chunk(std::uint64_t index) const noexcept;
  /// As MeshPlan::fill_chunk. Fields have the values at places that are not rounded yet.
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept;

  std::uint64_t bytes() const noexcept;

 private:
  struct Part {
    std::shared_ptr<const MeshPlan> plan;
    std::optional<WorldPoint> move;  ///< to the shared origin; nothing where it has that
    std::uint64_t first_chunk = 0, first_vertex = 0, first_tet = 0;
  };

  void add(const std::string& name, std::shared_ptr<const MeshPlan> plan, bool is_moved);
  const Part& part_of(std::uint64_t chunk) const noexcept;

  std::vector<Part> parts_;
  MeshHeader header_;
};

}  // namespace tet
