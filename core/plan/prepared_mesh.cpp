#include "core/plan/prepared_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/field/domain.h"
#include "core/field/find_scene_bricks.h"
#include "core/plan/budget.h"
#include "core/plan/check_tets.h"
#include "core/scene/grid_scene.h"
#include "core/volume/check_transform.h"

namespace tet {
namespace {

/// A scene in the place of a grid whose voxels are no cubes: its lattice lies in the world, and
/// every angle of a mesh is what it is of any.
std::shared_ptr<const Scene> stand_in_for(const Shape& shape, const CanonicalRequest& request) {
  const auto* volume = std::get_if<std::shared_ptr<const Volume>>(&shape);
  if (volume == nullptr || has_cubic_voxels((*volume)->transform)) return nullptr;
  return std::make_shared<const Scene>(
      scene_of_grid(*volume, static_cast<float>(request.iso), request.inside));
}

PhiField field_of(const Shape& shape, const CanonicalRequest& request, const Scene* stand_in) {
  PhiField field;
  field.scene = scene_of(shape);
  field.spacing_voxels = request.spacing;
  if (field.scene != nullptr) return field;
  const Volume& volume = *volume_of(shape);
  field.volume = &volume;
  field.iso = static_cast<float>(request.iso);
  field.inside = request.inside;
  if (stand_in != nullptr) {
    field.scene = stand_in;
    return field;
  }
  const double ratio = request.spacing / volume.transform.voxel_size;
  // A spacing typed with a few digits means the voxels themselves.
  constexpr double kSameSpacing = 1e-6;
  field.spacing_voxels = std::abs(ratio - 1) < kSameSpacing ? 1 : ratio;
  return field;
}

/// Finds whether both sides of a domain are meshed, or the inside, which must have an end.
absl::StatusOr<MeshedSpace> space_of(const PhiField& field,
                                     const MeshRequest& request,
                                     const MeshLimits& limits) {
  MeshedSpace space{.rules = stuffing_rules(request.preset),
                    .domain = {},
                    .manifold = request.manifold,
                    .kept_geometry_bytes = limits.kept_geometry_bytes,
                    .skip_topology = request.skip_statistics};
  space.most_bricks = most_surface_bricks(space.rules, limits);
  if (!space.rules.both_sides && !request.box) {
    if (auto status = check_inside_ends(field); !status.ok()) return status;
    return space;
  }
  const absl::StatusOr<BrickBox> domain = mesh_domain(field, request.box);
  if (!domain.ok()) return domain.status();
  if (space.rules.both_sides) {
    if (auto status = check_domain_budget(*domain, request.levels, limits); !status.ok()) {
      return status;
    }
  }
  space.domain = *domain;
  return space;
}

/// The bricks to look at, within budget.
absl::StatusOr<FoundBricks> bricks_of(const PhiField& field,
                                      const MeshedSpace& space,
                                      int levels,
                                      const MeshLimits& limits,
                                      const Cancellation& cancellation) {
  // A domain may leave few of many.
  const std::size_t most = most_found_bricks(field, space, limits),
                    of_all = space.domain ? kMaxSurfaceBricks : most;
  absl::StatusOr<FoundBricks> found =
      field.scene != nullptr ? find_scene_bricks(field, space.domain, of_all, cancellation)
                             : find_bricks(field, of_all, cancellation);
  if (!found.ok()) return found;
  if (space.domain && space.rules.both_sides) keep_domain(*space.domain, *found);
  if (space.domain && !space.rules.both_sides) keep_inside_of(*space.domain, field, *found);
  if (auto status = check_inside_budget(*found, levels, limits); !status.ok()) return status;
  if (auto status = check_plan_budget(*found, most); !status.ok()) return status;
  return found;
}

/// What follows one surface has none to follow where any number of labels meet.
absl::Status check_is_no_segmentation(const Shape& shape) {
  if (labels_of(shape) == nullptr) return absl::OkStatus();
  return absl::InvalidArgumentError("labels have no surface of one value");
}

}  // namespace

MeshRequest request_for_phi(MeshRequest request) {
  request.sizing = {};
  request.fields.clear();
  request.face_regions.clear();
  return request;
}

absl::StatusOr<MeshedField> meshed_field(const Shape& shape, const MeshRequest& request) {
  const absl::StatusOr<CanonicalRequest> asked = canonical(request, shape);
  if (!asked.ok()) return asked.status();
  if (auto status = check_is_no_segmentation(shape); !status.ok()) return status;
  std::shared_ptr<const Scene> stand_in = stand_in_for(shape, *asked);
  const PhiField phi = field_of(shape, *asked, stand_in.get());
  return MeshedField{std::move(stand_in), phi};
}

namespace {

/// Lattice coordinates, doubled, are numbers of 32 bits. Voxels' own fit.
absl::Status check_reach(const PhiField& field) {
  if (field.scene != nullptr || field.spacing_voxels >= 1) return absl::OkStatus();
  const auto [min, max] = stored_box(*field.volume);
  double farthest = 0;
  for (const std::int32_t voxel : {min.x, min.y, min.z, max.x, max.y, max.z}) {
    farthest = std::max(farthest, std::abs(static_cast<double>(voxel)));
  }
  const double reach = farthest / field.spacing_voxels;
  if (reach <= kMaxVoxelCoord || min.x > max.x) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("the grid reaches %g spacings from its voxel 0; the limit is %d. Use a "
                      "larger spacing, or store the grid nearer to its voxel 0",
                      reach, kMaxVoxelCoord));
}

}  // namespace

absl::Status check_spacing(const PhiField& field) {
  if (auto status = check_reach(field); !status.ok()) return status;
  // Between two nodes thin walls are looked for voxel by voxel, so a brick takes as long as the
  // spacing is wide.
  constexpr double kMaxSpacingVoxels = 256;
  if (field.scene != nullptr || field.spacing_voxels <= kMaxSpacingVoxels)
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("the spacing is %g voxels; the limit is %g. Use a smaller spacing",
                      field.spacing_voxels, kMaxSpacingVoxels));
}

absl::StatusOr<PreparedMesh> prepare_mesh(const Shape& shape,
                                          const MeshRequest& request,
                                          const MeshLimits& limits,
                                          const Cancellation& cancellation) {
  const absl::StatusOr<CanonicalRequest> asked = canonical(request, shape);
  if (!asked.ok()) return asked.status();
  if (auto status = check_is_no_segmentation(shape); !status.ok()) return status;
  std::shared_ptr<const Scene> stand_in = stand_in_for(shape, *asked);
  const PhiField field = field_of(shape, *asked, stand_in.get());
  if (auto status = check_spacing(field); !status.ok()) return status;
  if (auto status = check_anything_inside(field, asked->iso); !status.ok()) return status;
  const absl::StatusOr<MeshedSpace> space = space_of(field, request, limits);
  if (!space.ok()) return space.status();
  absl::StatusOr<FoundBricks> bricks =
      bricks_of(field, *space, asked->levels, limits, cancellation);
  if (!bricks.ok()) return bricks.status();
  return PreparedMesh{*asked, std::move(stand_in), field, *space, *std::move(bricks)};
}

}  // namespace tet
