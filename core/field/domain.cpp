#include "core/field/domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/scene/scene.h"
#include "core/volume/to_voxel.h"

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
  VoxelBox box_{{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
};

absl::StatusOr<LatticeBox> lattice_box(const PhiField& field, const WorldBox& box) {
  const bool ordered = box.min.x < box.max.x && box.min.y < box.max.y && box.min.z < box.max.z;
  if (!ordered) {  // not-a-numbers end here too
    return absl::InvalidArgumentError(absl::StrFormat(
        "box (%g, %g, %g) to (%g, %g, %g) is empty: its first corner must be the lower one",
        box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z));
  }
  const auto [min, max] = to_voxel_span(field.lattice_transform(), box);
  return LatticeBox{{min.x, min.y, min.z}, {max.x, max.y, max.z}};
}

absl::StatusOr<LatticeBox> all_that_is_stored(const PhiField& field) {
  const VoxelBox box = stored_box(*field.volume);
  if (box.empty()) {
    return absl::FailedPreconditionError("the grid stores nothing, so it has no bounding box");
  }
  if (field.scene != nullptr) {
    return lattice_box(field, field.volume->transform.to_world_box(
                                  {1.0 * box.min.x, 1.0 * box.min.y, 1.0 * box.min.z},
                                  {1.0 * box.max.x, 1.0 * box.max.y, 1.0 * box.max.z}));
  }
  const double spacing = field.spacing_voxels;
  return LatticeBox{{box.min.x / spacing, box.min.y / spacing, box.min.z / spacing},
                    {box.max.x / spacing, box.max.y / spacing, box.max.z / spacing}};
}

/// All that is inside of a scene, and a few cells around it: for rounding errors, and so that
/// no face of the box touches the surface.
absl::StatusOr<LatticeBox> all_that_is_reached(const PhiField& field) {
  if (auto status = check_inside_ends(field); !status.ok()) return status;
  const auto& [min, max] = field.scene->extent;
  if (!(min.x <= max.x)) {
    return absl::FailedPreconditionError("nothing of the scene is inside");
  }
  const double spacing = field.spacing_voxels;
  constexpr double kAround = 2;
  return LatticeBox{
      {min.x / spacing - kAround, min.y / spacing - kAround, min.z / spacing - kAround},
      {max.x / spacing + kAround, max.y / spacing + kAround, max.z / spacing + kAround}};
}

/// Rotations leave rounding errors; a face this near a brick's face is meant to lie on it.
constexpr double kOnTheFace = 1e-6;
constexpr double kMostUnits = 512;

absl::StatusOr<BrickBox> whole_bricks(const absl::StatusOr<LatticeBox>& asked,
                                      const char* what) {
  if (!asked.ok()) return asked.status();
  constexpr std::int32_t kMostSpacings = kMaxVoxelCoord / 2;
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = std::max(std::abs(asked->min[axis]), std::abs(asked->max[axis]));
    if (!(reach <= kMostSpacings)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the %s reaches %g spacings from the origin; the limit is %d. Use a "
                          "larger spacing",
                          what, reach, kMostSpacings));
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
  return BrickBox{{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

}  // namespace

absl::Status check_voxel_reach(const BrickBox& domain,
                               const std::array<double, 3>& spacing_voxels) {
  constexpr double kMostVoxels = 2.0 * kMaxVoxelCoord;
  const std::array<std::int32_t, 3> min{domain.min.x, domain.min.y, domain.min.z},
      max{domain.max.x, domain.max.y, domain.max.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = std::max(std::abs(1.0 * min[axis]), std::abs(max[axis] + 1.0)) *
                         kBrickEdge * spacing_voxels[axis];
    if (reach <= kMostVoxels) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("what is meshed reaches %g voxels from the first one; the limit is %g. "
                        "Use a nearer box",
                        reach, kMostVoxels));
  }
  return absl::OkStatus();
}

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

absl::StatusOr<BrickBox> mesh_domain(const PhiField& field,
                                     const std::optional<WorldBox>& box) {
  if (!box && field.volume == nullptr) return reached_bricks(field);
  absl::StatusOr<BrickBox> domain =
      whole_bricks(box ? lattice_box(field, *box) : all_that_is_stored(field), "box");
  if (!domain.ok() || field.scene != nullptr) return domain;
  const double spacing = field.spacing_voxels;
  if (auto s = check_voxel_reach(*domain, {spacing, spacing, spacing}); !s.ok()) return s;
  return domain;
}

absl::StatusOr<BrickBox> reached_bricks(const PhiField& field) {
  return whole_bricks(all_that_is_reached(field), "scene");
}

}  // namespace tet
