#include "core/plan/mesh_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/mesh/find_faces.h"
#include "core/octree/sized_cells.h"
#include "core/plan/check_face_regions.h"
#include "core/plan/request_rules.h"
#include "core/scene/scene.h"
#include "core/volume/check_transform.h"
#include "core/volume/inside.h"
#include "core/volume/label_volume.h"

namespace tet {
namespace {

constexpr std::array<std::pair<Preset, std::string_view>, 3> kPresetNames{{
    {Preset::kDefault, "default"},
    {Preset::kMinAngle, "min-angle"},
    {Preset::kBothSides, "both-sides"},
}};

/// 0 where it has no end.
double longest_extent(const Scene& scene) {
  const auto& [min, max] = scene.extent;
  const double longest = std::max({max.x - min.x, max.y - min.y, max.z - min.z});
  return std::isfinite(longest) ? longest : 0;
}

/// What is wrong with a field of the sizing is known as a field of the request.
absl::Status check_sizing_of(const MeshRequest& request, double spacing) {
  absl::Status status = check_sizing(request.sizing);
  if (status.ok()) status = check_sizing(request.sizing, spacing);
  if (status.ok() && request.sizing.grid && request.sizing.grid->volume == nullptr) {
    status = absl::InvalidArgumentError("grid is not loaded");
  }
  if (status.ok()) return status;
  return absl::InvalidArgumentError(absl::StrCat(kSizingField, ".", status.message()));
}

/// Where the inside has to have an end of its own, a background that is inside is told of by
/// check_inside_ends.
absl::Status check_inside_of(const Volume& volume, const MeshRequest& request, double iso) {
  if (auto status = check_side(volume, request.inside); !status.ok()) return status;
  const bool has_box = request.box || stuffing_rules(request.preset).both_sides;
  return has_box ? check_background(volume, request.inside, iso) : absl::OkStatus();
}

/// Regions are pieces of faces, and only scenes have nodes.
absl::Status check_regions_of(const MeshRequest& request, const Shape& shape) {
  if (auto status = check_face_regions(request.face_regions); !status.ok()) return status;
  if (!request.face_regions.empty() && !request.faces) {
    return absl::InvalidArgumentError(absl::StrCat(
        kFaceRegionsField, " is set without faces, which they are pieces of: set faces"));
  }
  if (request.fidelity && !request.faces) {
    return absl::InvalidArgumentError(
        "fidelity is set without faces, which are what is measured: set faces");
  }
  const Scene* const scene = scene_of(shape);
  return check_face_nodes(request.face_regions,
                          scene != nullptr ? scene->node_names : std::vector<std::string>());
}

/// A segmentation is read as one where its labels are asked for, and nowhere else. Several
/// grids and a scene may be meshed as labels, too: each solid is one.
absl::Status check_labels_of(const MeshRequest& request, const Shape& shape) {
  const bool has_labels = labels_of(shape) != nullptr;
  if (request.labels && volume_of(shape) != nullptr) {
    return absl::InvalidArgumentError(
        "labels are asked for of what was not read as a segmentation");
  }
  if (!request.labels && has_labels) {
    return absl::InvalidArgumentError("labels must be set: what is meshed is a segmentation");
  }
  if (!request.labels) return absl::OkStatus();
  const bool is_smoothed =
      request.labels->kernel != LabelKernel::kGauss || request.labels->smooth != kDefaultSmooth;
  if (is_smoothed && !has_labels) {
    return absl::InvalidArgumentError(
        "labels.smooth rounds off voxels, and solids have none: leave it out");
  }
  return check_label_choice(*request.labels);
}

/// A spacing does not follow from every scene.
absl::Status check_scene_spacing(const MeshRequest& request, const Scene& scene) {
  if (request.spacing || longest_extent(scene) > 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      scene.ends() ? "spacing must be given: nothing of the scene is inside"
                   : "spacing must be given: " + scene.endless + " has no end");
}

}  // namespace

Statistics statistics_of(const MeshRequest& request) {
  return request.skip_statistics ? Statistics::kSkipped : Statistics::kMeasured;
}

void ask_for_counts(MeshRequest& request) {
  request.improve = false;
  for (FaceRegion& region : request.face_regions) region.creases.reset();
  std::erase_if(request.face_regions,
                [](const FaceRegion& region) { return !region.has_condition(); });
}

bool has_cut(const MeshRequest& request) {
  return request.box && !request.labels && !stuffing_rules(request.preset).both_sides;
}

bool is_made_whole(const MeshRequest& request) {
  return request.sizing.grade_surface || has_cut(request);
}

std::vector<FieldArray> arrays_of(const MeshRequest& request) {
  std::vector<FieldArray> arrays = arrays_of(request.fields);
  if (has_cut(request)) arrays.push_back({kCutFaceArray, 1});
  return arrays;
}

void set_face_labels(const MeshRequest& request, bool in_box, MeshHeader& header) {
  if (!request.faces) return;
  header.face_labels = face_labels_of(header.has_regions, in_box);
  add_region_labels(request.face_regions, header);
}

IndexType index_type_of(const MeshHeader& header, const MeshRequest& request) noexcept {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  const bool wide =
      header.vertex_count > kMost || (header.has_faces() && header.tet_count > kMost);
  return wide ? IndexType::kUint64 : request.indices.value_or(IndexType::kUint32);
}

double default_spacing(const Shape& shape) {
  constexpr double kParts = 128;
  if (const Scene* scene = scene_of(shape)) return longest_extent(*scene) / kParts;
  if (const auto labels = labels_of(shape)) return labels->transform.voxel_size;
  if (const GridList* grids = grids_of(shape)) {
    double least = grids->front()->transform.voxel_size;
    for (const auto& grid : *grids) least = std::min(least, grid->transform.voxel_size);
    return least;
  }
  return volume_of(shape)->transform.voxel_size;
}

double default_iso(const Shape& shape, const MeshRequest& request) {
  const Volume* volume = volume_of(shape);
  return volume != nullptr ? default_iso(*volume, request.inside) : 0;
}

std::optional<Preset> parse_preset(std::string_view name) {
  for (const auto& [preset, known] : kPresetNames) {
    if (known == name) return preset;
  }
  return std::nullopt;
}

std::string_view preset_name(Preset preset) {
  for (const auto& [known, name] : kPresetNames) {
    if (known == preset) return name;
  }
  return "unknown";
}

StuffingRules stuffing_rules(Preset preset) {
  switch (preset) {
    case Preset::kDefault:
      return {.limits = {0.25F, 0.35F}};
    case Preset::kMinAngle:
      return {.limits = {0.2675F, 0.3896F}};
    case Preset::kBothSides:
      return {.limits = {0.20F, 0.30F}, .both_sides = true};
  }
  return {};
}

AngleBounds angle_bounds(Preset preset, CoordinateType coordinates) {
  const bool rounded = coordinates == CoordinateType::kFloat32;
  switch (preset) {
    case Preset::kDefault:
      return rounded ? AngleBounds{11.2, 154.9} : AngleBounds{11.3, 154.7};
    case Preset::kMinAngle:
      return rounded ? AngleBounds{11.7, 161.3} : AngleBounds{11.8, 161.2};
    case Preset::kBothSides:
      return rounded ? AngleBounds{9.3, 157.6} : AngleBounds{9.4, 157.4};
  }
  return {};
}

int default_levels(const Sizing& sizing) noexcept {
  const bool bounds_every_leaf = sizing.coarsest || sizing.growth != 1 || sizing.grid;
  return bounds_every_leaf ? kMaxLevels : 1;
}

int default_levels(const MeshRequest& request) noexcept {
  const bool sizes_labels = request.labels && !request.labels->sizes.empty();
  return sizes_labels ? kMaxLevels : default_levels(request.sizing);
}

absl::StatusOr<CanonicalRequest> canonical(const MeshRequest& request, const Shape& shape) {
  const Features features = features_of(request) | features_of(shape);
  if (auto status = check_features(features, field_names(request)); !status.ok()) return status;
  if (auto status = check_labels_of(request, shape); !status.ok()) return status;
  if (const Scene* scene = scene_of(shape)) {
    if (auto status = check_scene_spacing(request, *scene); !status.ok()) return status;
  }
  CanonicalRequest out;
  out.spacing = request.spacing.value_or(default_spacing(shape));
  if (!(out.spacing > 0) || !std::isfinite(out.spacing)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("spacing %g is not a positive number", out.spacing));
  }
  if (auto status = check_edge("spacing", out.spacing); !status.ok()) return status;
  out.iso = request.iso.value_or(default_iso(shape, request));
  if (!std::isfinite(static_cast<float>(out.iso))) {
    return absl::InvalidArgumentError(absl::StrFormat("iso %g is not a finite float", out.iso));
  }
  if (const Volume* volume = volume_of(shape)) {
    out.inside = inside_side(*volume, request.inside);
    if (auto status = check_inside_of(*volume, request, out.iso); !status.ok()) return status;
  }
  out.levels = request.levels;
  if (out.levels < 0 || out.levels > kMaxLevels) {
    return absl::InvalidArgumentError(
        absl::StrFormat("levels %d is outside 0..%d", out.levels, kMaxLevels));
  }
  if (auto status = check_sizing_of(request, out.spacing); !status.ok()) return status;
  if (auto status = check_loaded_fields(request.fields); !status.ok()) return status;
  if (auto status = check_regions_of(request, shape); !status.ok()) return status;
  out.levels = levels_of(request.sizing, out.spacing, out.levels);
  out.preset = request.preset;
  return out;
}

}  // namespace tet
