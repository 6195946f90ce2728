// Points and coordinates. The type carries the space, so the wrong one does not compile.
#pragma once

#include <array>
#include <compare>
#include <cstdint>

namespace tet {

/// Position in the caller's world units.
struct WorldPoint {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const WorldPoint&, const WorldPoint&) = default;
};

/// Position in OpenVDB index space; voxel centres have integer coordinates.
struct VoxelPoint {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const VoxelPoint&, const VoxelPoint&) = default;
};

/// A voxel of the grid (OpenVDB index space).
struct VoxelCoord {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const VoxelCoord&, const VoxelCoord&) = default;
};

/// Index space is refused beyond this, so that doubled lattice coordinates fit an int32.
inline constexpr std::int32_t kMaxVoxelCoord = 1 << 29;

/// A brick: 8 x 8 x 8 cells of one octree level. At level l it starts at cell 8*(x, y, z),
/// whose edge is 2^l lattice spacings. Ordered x first: neighbours in + directions come later.
struct BrickCoord {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const BrickCoord&, const BrickCoord&) = default;
};

inline constexpr int kBrickEdge = 8;
inline constexpr int kBrickCells = kBrickEdge * kBrickEdge * kBrickEdge;

/// Axis-aligned box of voxels, both ends included; empty when `min.x > max.x`.
struct VoxelBox {
  VoxelCoord min{1, 1, 1}, max{0, 0, 0};
  bool empty() const noexcept { return min.x > max.x; }
};

struct WorldBox {
  WorldPoint min, max;
};

/// Which side of the surface a tet lies on; the value is its label in every format.
enum class MeshRegion : std::uint8_t { kInside = 1, kOutside = 2 };

}  // namespace tet
