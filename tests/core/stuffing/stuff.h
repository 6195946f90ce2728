// Stuffing single bricks in tests.
#pragma once

#include <memory>

#include "core/field/phi_field.h"
#include "core/stuffing/cut_points.h"
#include "core/stuffing/warp.h"

namespace tet::test {

struct StuffedForTest {
  BrickSamples samples;
  CutPoints cuts;
  WarpedLattice warped;
};

/// Everything found about one brick of a volume at its own voxel size.
inline std::unique_ptr<StuffedForTest> stuff(const Volume& volume,
                                             BrickCoord brick,
                                             const WarpLimits& limits = {}) {
  PhiField field;
  field.volume = &volume;
  PhiSampler sampler(field);
  auto stuffed = std::make_unique<StuffedForTest>();
  sampler.sample(brick, stuffed->samples);
  find_signs(stuffed->samples, stuffed->cuts.signs);
  find_cut_points(stuffed->samples, sampler, brick, stuffed->cuts);
  warp_lattice(stuffed->cuts, limits, stuffed->warped);
  return stuffed;
}

}  // namespace tet::test
