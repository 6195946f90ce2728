#include "core/plan/labelled/label_domain.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/field/domain.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/mesh_place.h"

namespace tet {
namespace {

BrickBox common_bricks(const BrickBox& a, const BrickBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
}

}  // namespace

absl::StatusOr<BrickBox> label_domain(const BrickBox& reached,
                                      std::string_view what,
                                      const VoxelTransform& lattice,
                                      const MeshRequest& request) {
  if (!request.box) return reached;
  // A grid that stores nothing says where a lattice lies.
  Volume place;
  place.transform = lattice;
  PhiField field;
  field.volume = &place;
  const absl::StatusOr<BrickBox> asked = mesh_domain(field, request.box);
  if (!asked.ok() || request.labels->mesh_background) return asked;
  const BrickBox common = common_bricks(*asked, reached);
  const bool any = common.min.x <= common.max.x && common.min.y <= common.max.y &&
                   common.min.z <= common.max.z;
  if (any) return common;
  const WorldBox has = world_box_of(reached, lattice);
  return absl::InvalidArgumentError(absl::StrFormat(
      "the box holds nothing of the %s, which lies between (%g, %g, %g) and (%g, %g, %g)", what,
      has.min.x, has.min.y, has.min.z, has.max.x, has.max.y, has.max.z));
}

absl::Status check_label_sizes(const LabelChoice& choice, double spacing) {
  for (std::size_t i = 0; i < choice.sizes.size(); ++i) {
    if (choice.sizes[i].size >= spacing) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s.sizes[%d].size %g is below the spacing %g: nothing is finer than where labels meet",
        kLabelsField, i, choice.sizes[i].size, spacing));
  }
  return absl::OkStatus();
}

void set_labels(const PlanJob& job, LabelNumbers numbers, LabelJob& out) {
  out.shape = job.shape;
  out.labels = std::move(numbers.labels);
  out.largest_leaf = std::move(numbers.largest_leaf);
  out.kept = numbers.kept;
  out.request = job.request;
  out.limits = job.limits;
  out.progress = job.progress;
}

}  // namespace tet
