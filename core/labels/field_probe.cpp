#include "core/labels/field_probe.h"

#include <algorithm>
#include <limits>

namespace tet {
namespace {

/// What slopes of scenes are measured over, spacings.
constexpr double kStep = 1e-4;

constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

FieldProbe::FieldProbe(std::span<const LabelledField> fields, Label background, Overlap overlap)
    : fields_(fields), background_(background), overlap_(overlap), phi_(fields.size()) {
  if (!fields.empty()) lattice_ = fields.front().field.lattice_transform();
}

WorldPhi& FieldProbe::phi(std::size_t solid) {
  std::unique_ptr<WorldPhi>& made = phi_[solid];
  if (made == nullptr) {
    made = std::make_unique<WorldPhi>(fields_[solid].field, kStep * lattice_.voxel_size);
  }
  return *made;
}

/// The less, the more a point is a solid's, or nobody's: below 0 where it is.
double FieldProbe::depth_of(std::size_t solid, const WorldPoint& world) {
  const bool nobodys = solid == kNobody;
  const double own = nobodys ? 0 : phi(solid).at(world);
  if (overlap_ == Overlap::kDeepest) return own;
  double depth = nobodys ? -kNever : own;
  for (std::size_t earlier = 0; earlier < std::min(solid, fields_.size()); ++earlier) {
    depth = std::max(depth, -phi(earlier).at(world));
  }
  return depth;
}

/// Finds the solid with a label whose the point is, or nearly so.
std::size_t FieldProbe::solid_of(Label label, const WorldPoint& world) {
  std::vector<std::size_t> of_label;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (fields_[i].label == label) of_label.push_back(i);
  }
  if (label == background_ || of_label.empty()) of_label.push_back(kNobody);
  if (of_label.size() == 1) return of_label[0];
  double least = kNever;
  std::size_t best = of_label[0];
  for (const std::size_t solid : of_label) {
    const double depth = depth_of(solid, world);
    if (depth >= least) continue;
    least = depth;
    best = solid;
  }
  return best;
}

bool FieldProbe::choose(std::span<const Label> labels, const WorldPoint& near) {
  const WorldPoint world = lattice_.to_world({near.x, near.y, near.z});
  chosen_ = labels.size();
  for (std::size_t i = 0; i < chosen_; ++i) solid_[i] = solid_of(labels[i], world);
  const std::span<std::size_t> chosen = std::span(solid_).first(chosen_);
  std::ranges::sort(chosen);
  return std::ranges::adjacent_find(chosen) == chosen.end();
}

/// Units of phi; slopes in the lattice.
ValueSlope FieldProbe::slope_of(std::size_t solid, const WorldPoint& world) {
  if (solid == kNobody) return {};
  const auto found = phi(solid).slope_at(world);
  const auto along = [&](std::size_t axis) {
    return lattice_.linear[0][axis] * found.gradient.x +
           lattice_.linear[1][axis] * found.gradient.y +
           lattice_.linear[2][axis] * found.gradient.z;
  };
  return {found.phi, {along(0), along(1), along(2)}};
}

void FieldProbe::at(const WorldPoint& p, std::span<ValueSlope> out) {
  const WorldPoint world = lattice_.to_world({p.x, p.y, p.z});
  const ValueSlope first = slope_of(solid_[0], world);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (overlap_ == Overlap::kFirst) {
      out[i] = i == 0 ? first : slope_of(solid_[i], world);
      continue;
    }
    const auto [value, slope] = slope_of(solid_[i + 1], world);
    out[i] = {first.value - value,
              {first.slope.x - slope.x, first.slope.y - slope.y, first.slope.z - slope.z}};
  }
}

}  // namespace tet
