// A grid as the mesher reads it: flat, sorted, immutable, and free of OpenVDB.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// How a grid's values tell inside from outside.
enum class VolumeKind : std::uint8_t {
  kLevelSet,     ///< inside where value < iso; values in world units
  kFogVolume,    ///< inside where value > iso; values are densities
  kField,        ///< there is no inside: values to be looked up
  kVectorField,  ///< one component of three of such values
};

/// Only such a volume can be meshed.
constexpr bool has_inside(VolumeKind kind) noexcept { return kind <= VolumeKind::kFogVolume; }

/// Volumes that make up one grid.
constexpr std::uint32_t components_of(VolumeKind kind) noexcept {
  return kind == VolumeKind::kVectorField ? 3 : 1;
}

/// Who says what kind a volume is of.
enum class KindSource : std::uint8_t {
  kMaker,   ///< whoever made it in memory
  kClass,   ///< the class that the file's grid has
  kValues,  ///< its values: it has no class, and they tell
  kNobody,  ///< it has no class, and its values do not tell: a request has to
};

/// The side of the iso value that is inside.
enum class InsideSide : std::uint8_t { kBelow, kAbove };

/// world = linear * voxel + translation. Of cubic voxels (core/volume/check_transform.h)
/// `linear` is `voxel_size` times a rotation, or a rotation and a mirror, up to what float32
/// matrices are off by: every angle is kept.
struct VoxelTransform {
  std::array<std::array<double, 3>, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<double, 3> translation{};
  double voxel_size = 1;  ///< of a voxel the shortest edge, world units

  friend bool operator==(const VoxelTransform&, const VoxelTransform&) = default;

  WorldPoint to_world(const VoxelPoint& p) const noexcept {
    const auto& a = linear;
    return {a[0][0] * p.x + a[0][1] * p.y + a[0][2] * p.z + translation[0],
            a[1][0] * p.x + a[1][1] * p.y + a[1][2] * p.z + translation[1],
            a[2][0] * p.x + a[2][1] * p.y + a[2][2] * p.z + translation[2]};
  }
  /// World box around a box of voxels.
  WorldBox to_world_box(const VoxelPoint& min, const VoxelPoint& max) const noexcept;
  bool mirrors() const noexcept;
};

/// A cube of `edge` voxels (128 or 4096) that holds one value throughout.
struct ConstantCube {
  VoxelCoord min;
  std::int32_t edge = 0;
  float value = 0;
};

/// 16 x 16 x 16 bricks of which at least one has values of its own.
struct Region {
  static constexpr int kEdgeBricks = 16;
  static constexpr std::uint32_t kConstant = ~0U;

  BrickCoord min;                               ///< a multiple of 16
  std::array<std::uint32_t, 4096> brick_index;  ///< at (x*16 + y)*16 + z; or kConstant
  std::array<float, 4096> constant;             ///< the value of a constant brick
};

/// Edges in voxels, the first two as powers of two.
inline constexpr int kBrickShift = 3, kRegionShift = 7;
inline constexpr std::int32_t kRegionVoxels = Region::kEdgeBricks * kBrickEdge;
inline constexpr std::int32_t kLargestCube = 4096;
static_assert(1 << kBrickShift == kBrickEdge && 1 << kRegionShift == kRegionVoxels);

struct ValueRange {
  float min = 0, max = 0;
};

/// A scalar grid: bricks with values, constant bricks between them, and the background
/// elsewhere.
///
/// Every value is finite. Immutable once built, so any number of threads may read it.
struct Volume {
  std::string name;
  VolumeKind kind = VolumeKind::kLevelSet;
  KindSource kind_source = KindSource::kMaker;
  VoxelTransform transform;
  float background = 0;

  std::vector<BrickCoord> bricks;   ///< sorted; bricks that have values
  std::vector<float> values;        ///< bricks.size() * 512, at brick*512 + (x*8 + y)*8 + z
  std::vector<ValueRange> ranges;   ///< bricks.size(); of the brick's 512 values
  std::vector<Region> regions;      ///< sorted by min
  std::vector<ConstantCube> cubes;  ///< sorted by min; none overlaps a region

  std::size_t size_bytes() const noexcept;
};

}  // namespace tet
