#include "core/plan/labelled/solid_request.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/field/domain.h"
#include "core/labels/field_labels.h"
#include "core/plan/labelled/label_domain.h"
#include "core/plan/labelled/label_numbers.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/mesh_place.h"
#include "core/plan/prepared_mesh.h"
#include "core/scene/grid_scene.h"
#include "core/scene/solids.h"
#include "core/volume/check_transform.h"

namespace tet {
namespace {

/// Solids on one lattice.
struct Solids {
  std::vector<PhiField> fields;
  std::vector<std::string> names;
  std::vector<std::shared_ptr<const Scene>> scenes;  ///< what fields are of, besides the shape
  std::string_view what;                             ///< has them, as messages call it
  Overlap overlap = Overlap::kDeepest;
  std::string inside_guess;
};

BrickBox joined(const std::optional<BrickBox>& a, const BrickBox& b) {
  if (!a) return b;
  return {
      {std::min(a->min.x, b.min.x), std::min(a->min.y, b.min.y), std::min(a->min.z, b.min.z)},
      {std::max(a->max.x, b.max.x), std::max(a->max.y, b.max.y), std::max(a->max.z, b.max.z)}};
}

absl::Status about_solid(const absl::Status& status, const std::string& name) {
  constexpr std::size_t kShown = 100;
  return {status.code(), absl::StrFormat("%s (grid '%s')", status.message(),
                                         absl::CHexEscape(name.substr(0, kShown)))};
}

/// What a grid alone is asked for, so that it is checked as one that is meshed alone.
MeshRequest request_of_one(const MeshRequest& request, double spacing) {
  MeshRequest one;
  one.spacing = spacing;
  one.box = request.box;
  return one;
}

/// Level sets of one lattice lie on it, and their values are its samples where it is theirs.
/// Those of several, or of voxels that are no cubes, lie on cubes along the world's axes.
absl::StatusOr<Solids> solids_of_grids(const GridList& grids,
                                       const MeshRequest& request,
                                       double spacing) {
  Solids solids;
  solids.what = "file";
  const VoxelTransform& first = grids.front()->transform;
  const bool have_one_lattice =
      has_cubic_voxels(first) &&
      std::ranges::all_of(grids, [&](const auto& grid) { return grid->transform == first; });
  for (const auto& grid : grids) {
    auto field = meshed_field(grid, request_of_one(request, spacing));
    if (!field.ok()) return about_solid(field.status(), grid->name);
    solids.inside_guess += inside_guess_of(field->phi, request);
    if (!have_one_lattice) {
      solids.scenes.push_back(
          field->stand_in != nullptr
              ? field->stand_in
              : std::make_shared<const Scene>(scene_of_grid(
                    grid, field->phi.iso, inside_side(*grid, field->phi.inside))));
      field->phi.scene = solids.scenes.back().get();
      field->phi.spacing_voxels = spacing;
    }
    if (auto s = check_spacing(field->phi); !s.ok()) return s;
    solids.fields.push_back(field->phi);
    solids.names.push_back(grid->name);
  }
  return solids;
}

/// Each part keeps bounds of its own of each grid that it samples.
absl::Status check_grids_of(const Scene& scene) {
  constexpr std::size_t kMostSamples = 64;
  std::size_t samples = 0;
  for (const scene::Instruction& op : scene.program) {
    samples += op.op == scene::Op::kGrid ? 1 : 0;
  }
  if (samples <= kMostSamples) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("scene has %d grids, every copy counted; as labels the limit is %d",
                      samples, kMostSamples));
}

absl::StatusOr<Solids> solids_of_scene(const Scene& scene, double spacing) {
  if (!scene.blended.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "scene.", scene.blended,
        " blends the parts that are to be labels: leave it out, and blend within parts"));
  }
  if (auto s = check_grids_of(scene); !s.ok()) return s;
  Solids solids;
  solids.what = "scene";
  solids.overlap = Overlap::kFirst;
  solids.inside_guess = scene.inside_guess;
  solids.names = names_of_solids(scene);
  solids.scenes = solids_of(scene);
  for (const auto& solid : solids.scenes) {
    PhiField field;
    field.scene = solid.get();
    field.spacing_voxels = spacing;
    solids.fields.push_back(field);
  }
  return solids;
}

/// All that is inside of a solid, and a little around it; nothing where there is no such thing.
absl::StatusOr<std::optional<BrickBox>> bricks_of_solid(const PhiField& field) {
  if (field.scene == nullptr) {
    if (auto s = check_inside_ends(field); !s.ok()) return s;
    const absl::StatusOr<BrickBox> stored = mesh_domain(field, std::nullopt);
    if (absl::IsFailedPrecondition(stored.status())) return std::nullopt;
    if (!stored.ok()) return stored.status();
    // Between the last voxel that is stored and the next one there may be surface.
    const auto voxel = static_cast<std::int32_t>(1 / (kBrickEdge * field.spacing_voxels));
    const std::int32_t more = 1 + voxel;  // bricks
    return BrickBox{{stored->min.x - more, stored->min.y - more, stored->min.z - more},
                    {stored->max.x + more, stored->max.y + more, stored->max.z + more}};
  }
  if (field.scene->extent.min.x > field.scene->extent.max.x) return std::nullopt;
  const absl::StatusOr<BrickBox> reached = reached_bricks(field);
  if (!reached.ok()) return reached.status();
  return *reached;
}

/// Where the solids are; of some without an end only a box tells.
absl::StatusOr<BrickBox> bricks_of_solids(const Solids& solids, const MeshRequest& request) {
  if (request.box) {
    Volume place;
    place.transform = solids.fields.front().lattice_transform();
    PhiField field;
    field.volume = &place;
    const absl::StatusOr<BrickBox> domain = mesh_domain(field, request.box);
    if (!domain.ok()) return domain;
    for (const PhiField& solid : solids.fields) {
      const double spacing = solid.spacing_voxels;
      if (solid.scene != nullptr) continue;
      if (auto s = check_voxel_reach(*domain, {spacing, spacing, spacing}); !s.ok()) return s;
    }
    return domain;
  }
  std::optional<BrickBox> all;
  for (std::size_t i = 0; i < solids.fields.size(); ++i) {
    const auto one = bricks_of_solid(solids.fields[i]);
    if (!one.ok()) return about_solid(one.status(), solids.names[i]);
    if (*one) all = joined(all, **one);
  }
  if (all) return *all;
  return absl::FailedPreconditionError(
      absl::StrFormat("there is nothing to mesh: nothing of the %s is inside", solids.what));
}

/// The request's names, and those of solids that it does not name.
LabelChoice with_names(LabelChoice choice, const std::vector<std::string>& names) {
  std::vector<std::int64_t> named;
  for (const LabelName& name : choice.names) named.push_back(name.value);
  std::ranges::sort(named);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto value = static_cast<std::int64_t>(i + 1);
    if (std::ranges::binary_search(named, value) || !is_label_name(names[i])) continue;
    choice.names.push_back({value, names[i]});
  }
  return choice;
}

/// Keeps what fields refer to for as long as the source is there.
class KeptSolids final : public LabelSource {
 public:
  KeptSolids(Shape shape,
             std::vector<std::shared_ptr<const Scene>> scenes,
             std::unique_ptr<const FieldLabels> labels)
      : shape_(std::move(shape)), scenes_(std::move(scenes)), labels_(std::move(labels)) {}

  std::unique_ptr<LabelSampler> sampler() const override { return labels_->sampler(); }
  std::unique_ptr<InterfaceProbe> probe() const override { return labels_->probe(); }

 private:
  const Shape shape_;
  const std::vector<std::shared_ptr<const Scene>> scenes_;
  const std::unique_ptr<const FieldLabels> labels_;
};

}  // namespace

absl::StatusOr<LabelJob> make_solid_job(const PlanJob& job) {
  const auto asked = canonical(job.request, job.shape);
  if (!asked.ok()) return asked.status();
  const GridList* const grids = grids_of(job.shape);
  absl::StatusOr<Solids> solids = grids != nullptr
                                      ? solids_of_grids(*grids, job.request, asked->spacing)
                                      : solids_of_scene(*scene_of(job.shape), asked->spacing);
  if (!solids.ok()) return solids.status();
  std::vector<std::int64_t> values(solids->fields.size());
  std::iota(values.begin(), values.end(), 1);
  absl::StatusOr<LabelNumbers> numbers =
      number_labels({values, solids->what}, with_names(*job.request.labels, solids->names));
  if (!numbers.ok()) return numbers.status();
  if (auto s = check_label_sizes(*job.request.labels, asked->spacing); !s.ok()) return s;
  const auto domain = bricks_of_solids(*solids, job.request);
  if (!domain.ok()) return domain.status();
  LabelJob out;
  out.lattice = solids->fields.front().lattice_transform();
  out.domain = *domain;
  out.inside_guess = solids->inside_guess;
  std::vector<LabelledField> fields;
  for (std::size_t i = 0; i < values.size(); ++i) {
    fields.push_back({solids->fields[i], numbers->of_known[i]});
  }
  out.source = std::make_shared<const KeptSolids>(
      job.shape, std::move(solids->scenes),
      std::make_unique<const FieldLabels>(std::move(fields), numbers->background,
                                          solids->overlap));
  set_labels(job, *std::move(numbers), out);
  return out;
}

}  // namespace tet
