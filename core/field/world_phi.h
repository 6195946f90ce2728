// phi at points that lie anywhere in the world, and how fast it grows there.
#pragma once

#include <memory>
#include <optional>

#include "core/base/types.h"
#include "core/base/vec3.h"
#include "core/field/phi_field.h"
#include "core/volume/to_voxel.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// phi at a point and how fast it grows there, per world unit.
struct PhiSlope {
  double phi = 0;
  Vector gradient{};
};

/// The field as it is meshed, in double: trilinear between voxels, or the scene's. What it says
/// of a point depends on the point alone. Not thread-safe: one per task.
class WorldPhi {
 public:
  /// `step`: what a scene's slope is measured over, world units.
  WorldPhi(const PhiField& field, double step);
  ~WorldPhi();
  WorldPhi(WorldPhi&&) noexcept;
  WorldPhi& operator=(WorldPhi&&) noexcept;

  double at(const WorldPoint& p) noexcept;
  /// The slope in a volume is that of the cell of eight voxels around `p`.
  PhiSlope slope_at(const WorldPoint& p) noexcept;

 private:
  PhiSlope slope_in_volume(const WorldPoint& p) noexcept;
  PhiSlope slope_in_scene(const WorldPoint& p) noexcept;

  PhiField field_;
  double step_;
  std::optional<VolumeReader> reader_;     // of a volume
  std::optional<ToVoxel> to_voxel_;        // of a volume
  std::unique_ptr<SceneEvaluator> scene_;  // of a scene
};

}  // namespace tet
