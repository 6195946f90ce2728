// How a surface bends, and how thick the walls behind it are, at one place.
#pragma once

#include "core/base/types.h"
#include "core/field/phi_field.h"

namespace tet {

/// Asks a field around points near its surface; all lengths are finest spacings. Differences
/// are taken over three voxels of a volume, or three spacings where those are wider: what is
/// smaller is taken for noise, and an edge for a rounded one. Not thread-safe: one per task.
class SurfaceProbe {
 public:
  explicit SurfaceProbe(const PhiField& field);

  /// Goes to the surface next to `p`, which lies less than two steps from it.
  void visit(const VoxelPoint& p) noexcept;

  /// The larger of the two principal curvatures, whichever way it bends; 0 where phi is flat.
  double curvature() const noexcept;

  /// How far the inside reaches behind the surface, straight on; `most` where it is farther.
  double thickness(double most) noexcept;

 private:
  double at(const VoxelPoint& p) noexcept { return sampler_.at(p.x, p.y, p.z); }
  VoxelPoint gradient(const VoxelPoint& p) noexcept;
  void measure_hessian() noexcept;

  PhiSampler sampler_;
  double step_;            ///< half of what differences are taken over
  VoxelPoint at_surface_;  ///< where it was sent to
  VoxelPoint normal_;      ///< outward, of length 1; 0 where phi is flat
  double slope_ = 0;       ///< of phi along it
  double hessian_[3][3] = {};
};

}  // namespace tet
