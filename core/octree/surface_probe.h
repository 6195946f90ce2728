// How a surface bends, and how thick the walls behind it are, at one place.
#pragma once

#include <array>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"

namespace tet {

/// Finest spacings along the three axes of the lattice.
struct StoredExtent {
  std::array<double, 3> min{}, max{};
};

/// The box beyond which a volume has nothing but its background, where that is inside: whoever
/// has left it will meet no surface. None of other fields.
std::optional<StoredExtent> stored_extent_amid_inside(const PhiField& field);

/// Asks a field around points near its surface; all lengths are finest spacings. Differences
/// are taken over three voxels of a volume, or three spacings where those are wider: what is
/// smaller is taken for noise, and an edge for a rounded one. Not thread-safe: one per task.
class SurfaceProbe {
 public:
  /// `extent` is that of stored_extent_amid_inside, which who has many probes finds once.
  explicit SurfaceProbe(const PhiField& field,
                        const std::optional<StoredExtent>& extent = std::nullopt);

  /// From now on it looks at `cancellation`, which must outlive it, also on a long way through
  /// the inside. What it tells is made up once a look found it cancelled.
  void stop_when(const Cancellation& cancellation) noexcept;

  /// Goes to the surface next to `p`, which lies less than two steps from it.
  void visit(const VoxelPoint& p) noexcept;

  /// The larger of the two principal curvatures, whichever way it bends; 0 where phi is flat.
  double curvature() const noexcept;

  /// How far the inside reaches behind the surface, straight on; `most` where it is farther.
  /// Takes as long as what is stored there is deep, however large `most` is.
  double thickness(double most) noexcept;

 private:
  double at(const VoxelPoint& p) noexcept { return sampler_.at(p.x, p.y, p.z); }
  VoxelPoint gradient(const VoxelPoint& p) noexcept;
  void measure_hessian() noexcept;
  double depth_of_extent() const noexcept;

  PhiSampler sampler_;
  std::optional<StoredExtent> extent_;
  const Cancellation* cancellation_ = nullptr;
  double step_;            ///< half of what differences are taken over
  VoxelPoint at_surface_;  ///< where it was sent to
  VoxelPoint normal_;      ///< outward, of length 1; 0 where phi is flat
  double slope_ = 0;       ///< of phi along it
  double hessian_[3][3] = {};
};

}  // namespace tet
