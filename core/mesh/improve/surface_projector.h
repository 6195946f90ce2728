// Moving points onto the surface of a field.
#pragma once

#include <memory>
#include <optional>

#include "core/base/tet_geometry.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/field/world_phi.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/volume/to_voxel.h"
#include "core/volume/volume_reader.h"

namespace tet {

class SceneEvaluator;

/// The surface as stored positions see it. Not thread-safe: one per task.
class SurfaceProjector {
 public:
  // In spacings, and measured as phi over its slope.
  static constexpr double kOnSurface = 1e-3;  ///< a vertex within this is on the surface
  static constexpr double kTolerance = 1e-4;  ///< of a projected point
  static constexpr double kReach = 0.5;       ///< of a projection

  SurfaceProjector(const PhiField& field,
                   const LatticeToWorld& to_world,
                   const MeshHeader& mesh);

  ~SurfaceProjector();
  SurfaceProjector(SurfaceProjector&&) noexcept;
  SurfaceProjector& operator=(SurfaceProjector&&) noexcept;

  /// phi at a stored position: trilinear, or the scene's.
  PhiSlope at(const WorldPoint& p) noexcept;

  bool is_on_surface(const PhiSlope& here) const noexcept;

  /// A point of the surface as it would be stored, on the line through `p` along `slope`, which
  /// tells how steep phi is; nothing when a few secants find none within reach.
  std::optional<WorldPoint> project(const WorldPoint& p, const Vector& slope) noexcept;

  /// Rounds a position as the mesh would store it.
  WorldPoint rounded(const WorldPoint& p) const noexcept;

 private:
  PhiSlope at_voxel(double x, double y, double z) noexcept;
  PhiSlope at_world(const WorldPoint& p) noexcept;

  PhiField field_;
  std::optional<VolumeReader> reader_;     // of a volume
  std::unique_ptr<SceneEvaluator> scene_;  // of a scene
  InverseLinear to_voxels_;                // of stored positions
  double per_divisor_;                     // 1 / to_voxels_.divisor
  VoxelPoint origin_;                      // whole voxels, which are exact anywhere
  VoxelPoint beyond_origin_;               // and the rest
  double spacing_;
  bool floats_;
};

}  // namespace tet
