// Volumes from bricks and constants: sorted, indexed and checked.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// A brick that holds one value throughout.
struct ConstantBrick {
  BrickCoord brick;
  float value = 0;
};

/// Whether a volume may have this background. Whoever looks for what differs from it asks
/// first: everything differs from NaN. Errors: kFailedPrecondition (it is not finite).
absl::Status check_background(float background);

/// Fills in what follows from a volume's bricks, values, cubes and `constants`: the ranges, the
/// regions, and the order of the cubes.
///
/// `volume.bricks` is sorted and unique, with its `values` in place; cubes and constants come
/// in any order. Parallel over bricks. Errors: kFailedPrecondition (a value that is not finite,
/// a coordinate beyond kMaxVoxelCoord), kInvalidArgument (something twice in one place, a cube
/// that is not aligned to its own edge), kCancelled.
absl::StatusOr<Volume> index_volume(Volume volume,
                                    std::vector<ConstantBrick> constants,
                                    const Cancellation& cancellation = Cancellation());

/// Gathers a volume piece by piece, in any order; where nothing is added the background is.
///
/// Not thread-safe.
class VolumeBuilder {
 public:
  VolumeBuilder(VolumeKind kind, float background, const VoxelTransform& transform = {});

  /// `values` at (x*8 + y)*8 + z.
  void add_brick(BrickCoord brick, std::span<const float, kBrickCells> values);
  void add_constant_brick(BrickCoord brick, float value);
  /// `edge` is 128 or 4096 voxels, and `min` a multiple of it.
  void add_constant_cube(VoxelCoord min, std::int32_t edge, float value);

  /// The volume of all that was added. Errors: those of `index_volume`.
  absl::StatusOr<Volume> build() &&;

 private:
  Volume volume_;  // bricks and values in the order they came
  std::vector<ConstantBrick> constants_;
};

}  // namespace tet
