#include "core/plan/labelled/label_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/field/domain.h"
#include "core/plan/labelled/label_domain.h"
#include "core/plan/labelled/label_numbers.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/labelled/solid_request.h"
#include "core/plan/labelled/volume_labels.h"
#include "core/volume/check_transform.h"
#include "core/volume/label_volume.h"
#include "core/volume/to_voxel.h"

namespace tet {
namespace {

/// The axes that the lattice lies along: the voxels', where these are at right angles, else the
/// world's with voxels as long as the shortest edge; and the image's box on them.
struct LatticeAxes {
  VoxelTransform voxels;
  std::array<double, 3> low{}, high{};  ///< of the image, faces of its outermost voxels

  explicit LatticeAxes(const LabelVolume& volume);
  /// Whether the axes are the image's own.
  bool are_the_images = true;
};

LatticeAxes::LatticeAxes(const LabelVolume& volume) : voxels(volume.transform) {
  const VoxelBox& box = volume.box;
  low = {box.min.x - 0.5, box.min.y - 0.5, box.min.z - 0.5};
  high = {box.max.x + 0.5, box.max.y + 0.5, box.max.z + 0.5};
  if (are_square(volume.transform)) return;
  are_the_images = false;
  const double edge = volume.transform.voxel_size;
  voxels = {};
  voxels.linear = {{{edge, 0, 0}, {0, edge, 0}, {0, 0, edge}}};
  voxels.voxel_size = edge;
  const WorldBox world =
      volume.transform.to_world_box({low[0], low[1], low[2]}, {high[0], high[1], high[2]});
  low = {world.min.x / edge, world.min.y / edge, world.min.z / edge};
  high = {world.max.x / edge, world.max.y / edge, world.max.z / edge};
}

/// Who asks for a spacing so near a voxel's edge means that.
bool is_edge(double ratio) { return std::abs(ratio - 1) < 1e-6; }

std::array<double, 3> spacing_in_voxels(const VoxelTransform& voxels, double spacing) {
  std::array<double, 3> ratios = voxel_edges(voxels);
  for (double& ratio : ratios) {
    ratio = spacing / ratio;
    if (is_edge(ratio)) ratio = 1;
  }
  return ratios;
}

/// A lattice of cubes along the voxels' axes, whatever their edges. Its nodes lie where their
/// values are taken from: where the spacing is meant to be an edge it is one, but for rounding.
VoxelTransform lattice_along(const VoxelTransform& voxels, double spacing) {
  constexpr double kRounding = 1e-12;
  VoxelTransform lattice = voxels;
  const std::array<double, 3> edges = voxel_edges(voxels);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double ratio = spacing / edges[axis];
    if (is_edge(ratio) && std::abs(ratio - 1) > kRounding) continue;
    for (auto& row : lattice.linear) row[axis] *= ratio;
  }
  lattice.voxel_size = spacing;
  return lattice;
}

/// How far a kernel reaches along an axis, voxels.
double reach_of(const LabelChoice& choice, double spacing_voxels) {
  const double step = std::max(1.0, spacing_voxels);
  const double smooth = choice.kernel == LabelKernel::kGauss ? choice.smooth : 0;
  return step * std::max(1.5, 3 * smooth);
}

/// A brick's nodes look at all voxels between them, and around: at no more along an axis than
/// fit a core's cache a few times over.
absl::Status check_label_spacing(const LabelChoice& choice,
                                 const std::array<double, 3>& spacing_voxels) {
  constexpr double kBrickNodes = 12, kMostVoxels = 320;
  for (const double ratio : spacing_voxels) {
    const double voxels = kBrickNodes * ratio + 2 * reach_of(choice, ratio);
    if (voxels <= kMostVoxels) continue;
    const double most = ratio * kMostVoxels / voxels;
    return absl::InvalidArgumentError(absl::StrFormat(
        "the spacing is %g voxels; with this kernel the limit is %g. Use a smaller spacing, "
        "or smooth less",
        ratio, most));
  }
  return absl::OkStatus();
}

/// The bricks that the image reaches into, and what its outermost voxels reach.
absl::StatusOr<BrickBox> bricks_of_image(const LatticeAxes& axes,
                                         const LabelChoice& choice,
                                         const std::array<double, 3>& spacing_voxels) {
  constexpr std::int32_t kMostReach = kMaxVoxelCoord / 2;
  std::array<std::int32_t, 3> min{}, max{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double ratio = spacing_voxels[axis];
    // A node beside the image's end may move.
    const double reach = reach_of(choice, ratio) / ratio + 1;
    const double low = axes.low[axis] / ratio - reach, high = axes.high[axis] / ratio + reach;
    if (!(std::max(std::abs(low), std::abs(high)) <= kMostReach)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "the image reaches %g spacings from the origin; the limit is %d. Use a larger "
          "spacing",
          std::max(std::abs(low), std::abs(high)), kMostReach));
    }
    min[axis] = static_cast<std::int32_t>(std::floor(low / kBrickEdge));
    max[axis] = static_cast<std::int32_t>(std::floor(high / kBrickEdge));
  }
  return BrickBox{{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

std::shared_ptr<const LabelVoxels> voxels_on(const LatticeAxes& axes,
                                             const LabelVolume& volume,
                                             std::shared_ptr<const VolumeLabels> labels) {
  if (axes.are_the_images) return labels;
  ResampledLabels::Map map{InverseLinear(volume.transform).matrix(), {}};
  const auto& at = volume.transform.translation;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      map.shift[row] -= map.linear[row][axis] * at[axis];
      map.linear[row][axis] *= axes.voxels.voxel_size;
    }
  }
  return std::make_shared<const ResampledLabels>(std::move(labels), map);
}

}  // namespace

absl::StatusOr<LabelJob> make_label_job(const PlanJob& job) {
  if (labels_of(job.shape) == nullptr) return make_solid_job(job);
  const auto asked = canonical(job.request, job.shape);
  if (!asked.ok()) return asked.status();
  const std::shared_ptr<const LabelVolume> volume = labels_of(job.shape);
  const LabelChoice& choice = *job.request.labels;
  absl::StatusOr<LabelNumbers> numbers = number_labels({volume->labels}, choice);
  if (!numbers.ok()) return numbers.status();
  const LatticeAxes axes(*volume);
  const IndicatorRules rules{spacing_in_voxels(axes.voxels, asked->spacing), choice.kernel,
                             choice.smooth};
  if (auto s = check_label_sizes(choice, asked->spacing); !s.ok()) return s;
  if (auto s = check_label_spacing(choice, rules.spacing_voxels); !s.ok()) return s;
  const auto image = bricks_of_image(axes, choice, rules.spacing_voxels);
  if (!image.ok()) return image.status();
  LabelJob out;
  out.lattice = lattice_along(axes.voxels, asked->spacing);
  const auto domain = label_domain(*image, "image", out.lattice, job.request);
  if (!domain.ok()) return domain.status();
  if (auto s = check_voxel_reach(*domain, rules.spacing_voxels); !s.ok()) return s;
  out.domain = *domain;
  out.source = std::make_shared<const IndicatorLabels>(
      voxels_on(axes, *volume,
                std::make_shared<const VolumeLabels>(volume, std::move(numbers->of_known),
                                                     numbers->background)),
      rules);
  set_labels(job, *std::move(numbers), out);
  return out;
}

absl::StatusOr<std::shared_ptr<const LabelPlan>> plan_label_image(
    const PlanJob& job, const Cancellation& cancellation) {
  const absl::StatusOr<LabelJob> labels = make_label_job(job);
  if (!labels.ok()) return labels.status();
  return plan_labels(*labels, cancellation);
}

}  // namespace tet
