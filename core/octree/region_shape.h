// A region of a sizing on the lattice: which boxes of cells it reaches into.
#pragma once

#include <array>
#include <variant>

#include "core/base/types.h"
#include "core/octree/sizing.h"
#include "core/volume/to_voxel.h"

namespace tet {

/// A box along the lattice's axes, finest spacings.
struct LatticeSpan {
  std::array<double, 3> centre{}, half{};
};

enum class Reach { kNone, kPart, kAll };

/// Any region but a shell.
class RegionShape {
 public:
  /// `lattice`: see PhiField::lattice_transform.
  RegionShape(const SizingRegion& region, const VoxelTransform& lattice);

  /// Never kNone where the region reaches into the box, nor kAll where it leaves some of it
  /// out.
  Reach reach(const LatticeSpan& span) const noexcept;

  /// Box around it, finest spacings.
  const VoxelSpan& bounds() const noexcept { return bounds_; }

 private:
  /// Along the world's axes.
  struct Box {
    WorldBox box;
    VoxelTransform lattice;
  };
  /// Finest spacings.
  struct Capsule {
    std::array<double, 3> start{}, along{};
    double radius = 0;
  };

  void set(const std::monostate&, const VoxelTransform&) {}
  void set(const ShellRegion&, const VoxelTransform&) {}
  void set(const WorldBox& box, const VoxelTransform& lattice);
  void set(const BallRegion& ball, const VoxelTransform& lattice);
  void set(const CapsuleRegion& capsule, const VoxelTransform& lattice);

  static Reach reach(const Box& box, const LatticeSpan& span) noexcept;
  static Reach reach(const Capsule& capsule, const LatticeSpan& span) noexcept;

  std::variant<Box, Capsule> shape_;
  VoxelSpan bounds_;
};

}  // namespace tet
