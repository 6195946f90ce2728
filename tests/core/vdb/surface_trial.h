// One random surface, converted, and held against what it stands for.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include <absl/strings/str_format.h>

#include "core/vdb/openvdb/surface_to_volume.h"
#include "tests/support/random_surfaces.h"

namespace tet::test {

struct SurfaceTrial {
  std::string silent;  ///< what is wrong without a word; empty when nothing is
  bool refused = false, warned = false;
  std::string what;
};

/// A volume is right within what rounding the edges off takes.
inline SurfaceTrial trial_of_surface(std::uint64_t seed) {
  const RandomSurface made = random_surface(seed);
  SurfaceTrial trial;
  trial.what = absl::StrFormat("seed %d: %s", seed, made.what);
  const auto result = surface_to_volume(made.surface, made.voxel_size);
  if (!result.ok()) {
    trial.refused = true;
    trial.what += ": " + std::string(result.status().message());
    return trial;
  }
  const auto warnings = result->report.warnings();
  const double off = result->report.volume - made.volume;
  trial.warned = !warnings.empty();
  const double cube = std::pow(made.voxel_size, 3);
  trial.what += absl::StrFormat(": volume %.6g, right %.6g, area %.6g voxels%s",
                                result->report.volume / cube, made.volume / cube,
                                made.area / std::pow(made.voxel_size, 2),
                                trial.warned ? ", " + warnings[0] : "");
  if (!trial.warned && std::abs(off) > 0.05 * made.voxel_size * made.area) {
    trial.silent = trial.what + "; " + result->report.text();
  }
  return trial;
}

}  // namespace tet::test
