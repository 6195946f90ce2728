#include "core/field/domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

namespace tet {
namespace {

/// Along the three axes, units of the lattice spacing.
struct LatticeBox {
  std::array<double, 3> min{}, max{};
};

/// Voxels of the bricks that a volume stores, and of constants that are not the background.
class StoredBox {
 public:
  void add(VoxelCoord min, std::int32_t edge) {
    box_.min = {std::min(box_.min.x, min.x), std::min(box_.min.y, min.y),
                std::min(box_.min.z, min.z)};
    box_.max = {std::max(box_.max.x, min.x + edge), std::max(box_.max.y, min.y + edge),
                std::max(box_.max.z, min.z + edge)};
  }
  void add(BrickCoord b) {
    add({kBrickEdge * b.x, kBrickEdge * b.y, kBrickEdge * b.z}, kBrickEdge);
  }
  const VoxelBox& box() const noexcept { return box_; }

 private:
  VoxelBox box_{
      {INT32_MAX, INT32_MAX, INT32_MAX},
      {INT32_MIN, INT32_MIN, INT32_MIN}
  };
};

VoxelBox stored_box(const Volume& volume) {
  StoredBox stored;
  for (const BrickCoord brick : volume.bricks) stored.add(brick);
  for (const ConstantCube& cube : volume.cubes) {
    if (cube.value != volume.background) stored.add(cube.min, cube.edge);
  }
  constexpr int kEdge = Region::kEdgeBricks;
  for (const Region& region : volume.regions) {
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (region.brick_index[at] != Region::kConstant ||
          region.constant[at] == volume.background) {
        continue;
      }
      stored.add({region.min.x + i / (kEdge * kEdge), region.min.y + i / kEdge % kEdge,
                  region.min.z + i % kEdge});
    }
  }
  return stored.box();
}

absl::StatusOr<LatticeBox> all_that_is_stored(const PhiField& field) {
  const VoxelBox box = stored_box(*field.volume);
  if (box.empty()) {
    return absl::FailedPreconditionError("the grid stores nothing, so it has no bounding box");
  }
  const double spacing = field.spacing_voxels;
  return LatticeBox{
      {box.min.x / spacing, box.min.y / spacing, box.min.z / spacing},
      {box.max.x / spacing, box.max.y / spacing, box.max.z / spacing}
  };
}

/// The lattice's coordinates of a world point: `linear` is a rotation times the spacing.
std::array<double, 3> to_lattice(const VoxelTransform& lattice, const WorldPoint& p) {
  const std::array<double, 3> from{p.x - lattice.translation[0], p.y - lattice.translation[1],
                                   p.z - lattice.translation[2]};
  std::array<double, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) {
      at[axis] += lattice.linear[row][axis] * from[row];
    }
    at[axis] /= lattice.voxel_size * lattice.voxel_size;
  }
  return at;
}

absl::StatusOr<LatticeBox> lattice_box(const PhiField& field, const WorldBox& box) {
  const bool ordered = box.min.x < box.max.x && box.min.y < box.max.y && box.min.z < box.max.z;
  if (!ordered) {  // not-a-numbers end here too
    return absl::InvalidArgumentError(absl::StrFormat(
        "box (%g, %g, %g) to (%g, %g, %g) is empty: its first corner must be the lower one",
        box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z));
  }
  constexpr double kInf = std::numeric_limits<double>::infinity();
  LatticeBox out{
      { kInf,  kInf,  kInf},
      {-kInf, -kInf, -kInf}
  };
  const VoxelTransform lattice = field.lattice_transform();
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = to_lattice(lattice, {(corner & 1) != 0 ? box.max.x : box.min.x,
                                         (corner & 2) != 0 ? box.max.y : box.min.y,
                                         (corner & 4) != 0 ? box.max.z : box.min.z});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out.min[axis] = std::min(out.min[axis], at[axis]);
      out.max[axis] = std::max(out.max[axis], at[axis]);
    }
  }
  return out;
}

/// Rotations leave rounding errors; a face this near a brick's face is meant to lie on it.
constexpr double kOnTheFace = 1e-6;
constexpr double kMostUnits = 512;

}  // namespace

absl::StatusOr<BrickBox> mesh_domain(const PhiField& field,
                                     const std::optional<WorldBox>& box) {
  const absl::StatusOr<LatticeBox> asked =
      box ? lattice_box(field, *box) : all_that_is_stored(field);
  if (!asked.ok()) return asked.status();
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = std::max(std::abs(asked->min[axis]), std::abs(asked->max[axis]));
    if (!(reach <= kMaxVoxelCoord / 2)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "the box reaches %g spacings from the grid's origin; the limit is %d. Use a smaller "
          "box or a larger spacing",
          reach, kMaxVoxelCoord / 2));
    }
    longest = std::max(longest, asked->max[axis] - asked->min[axis]);
  }
  std::int32_t unit = kBrickEdge;
  while (unit * kMostUnits < longest) unit *= 2;
  std::array<std::int32_t, 3> min{}, max{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = std::floor(asked->min[axis] / unit + kOnTheFace);
    const double high = std::max(low + 1, std::ceil(asked->max[axis] / unit - kOnTheFace));
    min[axis] = static_cast<std::int32_t>(low) * (unit / kBrickEdge);
    max[axis] = static_cast<std::int32_t>(high) * (unit / kBrickEdge) - 1;
  }
  return BrickBox{
      {min[0], min[1], min[2]},
      {max[0], max[1], max[2]}
  };
}

}  // namespace tet
