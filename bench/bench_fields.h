// What the benchmarks mesh: solids of any size as narrow-band volumes, made in no time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/volume/volume.h"

namespace tet::bench {

enum class Solid : std::uint8_t {
  kBall,    ///< the least surface for its volume
  kTorus,   ///< three times as wide as it is thick
  kGyroid,  ///< walls 12 voxels thick, within a ball: surface nearly everywhere
};
inline constexpr std::array kSolids{Solid::kBall, Solid::kTorus, Solid::kGyroid};

const char* name_of(Solid solid);

/// A size by the tets of the uniform mesh, about; `label` is its place in a benchmark's name.
struct BenchSize {
  const char* label;
  double uniform_tets;
};
inline constexpr BenchSize kSmall{"1e5", 1e5};
inline constexpr BenchSize kMedium{"1e6", 1e6};
inline constexpr BenchSize kLarge{"1e7", 1e7};
inline constexpr BenchSize kHuge{"1e8", 1e8};

/// A level set with voxels of size 1 and a band of 3 on either side. Parallel.
std::shared_ptr<const Volume> make_solid(Solid solid, const BenchSize& size);

/// The demo's scanned model, about 2 world units wide, from Debian's glmark2-data package; null
/// where the package is not installed. Takes seconds.
std::shared_ptr<const Volume> make_bunny(double voxel_size);

}  // namespace tet::bench
