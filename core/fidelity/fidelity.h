// How far a mesh's surface is from the zero surface of phi, and back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/fidelity/shape_summary.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"

namespace tet {

/// Distances that were sampled on one surface, to another one; world units.
struct SurfaceDistance {
  double max = 0, rms = 0;
  WorldPoint at;  ///< where it is the largest
  std::uint64_t samples = 0;

  friend bool operator==(const SurfaceDistance&, const SurfaceDistance&) = default;
};

struct Fidelity {
  double spacing = 0;
  SurfaceDistance to_surface;    ///< from the mesh's surface to that of phi
  SurfaceDistance from_surface;  ///< from the surface of phi to the mesh's
  double mesh_area = 0, surface_area = 0;
  double mesh_volume = 0;  ///< of the tets inside
  /// What phi encloses; nothing where a box cuts the surface.
  std::optional<double> enclosed_volume;

  double hausdorff() const noexcept;
  friend bool operator==(const Fidelity&, const Fidelity&) = default;
};

/// What a request that asks for fidelity is told of its mesh.
struct MeshFidelity {
  std::vector<Fidelity> parts;  ///< one of one grid, or of several one a grid
  ShapeSummary shapes;

  friend bool operator==(const MeshFidelity&, const MeshFidelity&) = default;
};

/// Points at which distances are sampled each way, beside those that are looked at because they
/// are likely to be the worst.
inline constexpr std::size_t kFidelitySamples = std::size_t{1} << 15;

/// Holds a mesh of `request` and `shape` against phi: one answer, or of several grids one a
/// grid. Neither looks at what the mesher found: vertices may have been moved since. Parallel;
/// run it on a TaskPool; one answer for any number of threads. Errors: those of plan_mesh.
absl::StatusOr<std::vector<Fidelity>> measure_fidelity(const TetMesh& mesh,
                                                       const Shape& shape,
                                                       const MeshRequest& request,
                                                       const Cancellation& cancellation = {});

/// Does so, and measures the shapes of all tets.
absl::StatusOr<MeshFidelity> fidelity_of(const TetMesh& mesh,
                                         const Shape& shape,
                                         const MeshRequest& request,
                                         const Cancellation& cancellation = {});

}  // namespace tet
