// Where a volume has certain values.
#pragma once

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// Values above one number and below another.
struct WantedValues {
  double above = 0, below = 0;

  bool have(float value) const noexcept {
    const auto v = static_cast<double>(value);
    return v > above && v < below;
  }
};

/// The box of all voxels that have wanted values, but for the background: empty where none has.
VoxelBox box_of_values(const Volume& volume, const WantedValues& wanted);

}  // namespace tet
