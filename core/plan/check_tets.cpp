#include "core/plan/check_tets.h"

#include <string>

#include <absl/strings/str_format.h>

#include "core/scene/scene.h"
#include "core/volume/inside.h"

namespace tet {
namespace {

/// Tells which iso values a grid has a surface at; a scene has no others.
std::string values_of(const PhiField& field) {
  if (field.volume == nullptr) return "";
  const auto [min, max] = value_range(*field.volume);
  const InsideSide side = inside_side(*field.volume, field.inside);
  return absl::StrFormat(
      ": the grid's values are from %g to %g, and the inside is %s the iso value; choose "
      "another iso value, or the other side (--inside)",
      min, max, side_name(side));
}

bool has_values_inside(const PhiField& field, double iso) {
  const auto [min, max] = value_range(*field.volume);
  const bool below = inside_side(*field.volume, field.inside) == InsideSide::kBelow;
  return below ? double{min} < iso : double{max} > iso;
}

bool has_values_outside(const PhiField& field, double iso) {
  const auto [min, max] = value_range(*field.volume);
  const bool below = inside_side(*field.volume, field.inside) == InsideSide::kBelow;
  return below ? double{max} >= iso : double{min} <= iso;
}

/// What to change where no node is inside.
std::string remedy_of(const PreparedMesh& prepared) {
  const PhiField& field = prepared.field;
  const double spacing = prepared.asked.spacing;
  const bool in_box = prepared.space.domain.has_value();
  if (field.volume == nullptr) {
    return absl::StrFormat("; %sa solid thinner than spacing %g needs a smaller one",
                           in_box ? "move the box, or " : "", spacing);
  }
  if (!has_values_inside(field, prepared.asked.iso)) return values_of(field);
  const auto [min, max] = value_range(*field.volume);
  return absl::StrFormat(
      "; of the grid's values, from %g to %g, those inside lie %sbetween nodes of spacing %g: "
      "%suse a smaller spacing",
      min, max, in_box ? "outside the box, or " : "", spacing,
      in_box ? "move the box, or " : "");
}

/// Why there is no mesh, though what is meshed and the request are fine.
absl::Status nothing_to_mesh(const PreparedMesh& prepared, const ThinWalls& thin) {
  const CanonicalRequest& asked = prepared.asked;
  if (!thin.any()) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "nothing%s is inside at iso %g, so there is nothing to mesh%s",
        prepared.space.domain ? " in the box" : "", asked.iso, remedy_of(prepared)));
  }
  if (thin.suggested_spacing == 0) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "all that is inside at iso %g is thinner than spacing %g resolves, so nothing of it is "
        "left to mesh; use a smaller spacing, and sample a grid more finely that has no more "
        "than its edges to show",
        asked.iso, asked.spacing));
  }
  return absl::FailedPreconditionError(absl::StrFormat(
      "all that is inside at iso %g is thinner than spacing %g resolves, so nothing of it is "
      "left to mesh; a grid sampled and meshed at about %.3g would resolve it",
      asked.iso, asked.spacing, thin.suggested_spacing));
}

}  // namespace

absl::Status check_anything_inside(const PhiField& field, double iso) {
  if (field.volume == nullptr || field.scene == nullptr) return absl::OkStatus();
  const auto& [min, max] = field.scene->extent;
  if (min.x <= max.x) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "nothing is inside at iso %g, so there is nothing to mesh%s", iso, values_of(field)));
}

absl::Status check_any_surface(const PhiField& field, double iso) {
  if (field.volume == nullptr) return absl::OkStatus();
  const bool inside = has_values_inside(field, iso);
  if (inside && has_values_outside(field, iso)) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("%s is inside at iso %g, so there are no two sides to mesh%s",
                      inside ? "all" : "nothing", iso, values_of(field)));
}

absl::Status check_not_empty(const MeshHeader& header,
                             const PreparedMesh& prepared,
                             const ThinWalls& thin) {
  return header.tet_count > 0 ? absl::OkStatus() : nothing_to_mesh(prepared, thin);
}

absl::Status check_tets(const MeshHeader& header,
                        const PreparedMesh& prepared,
                        const ThinWalls& thin,
                        const MeshLimits& limits) {
  if (auto status = check_not_empty(header, prepared, thin); !status.ok()) return status;
  if (header.tet_count <= limits.max_tets) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("the mesh would have %d tets; the limit is %d. Use a larger spacing",
                      header.tet_count, limits.max_tets));
}

}  // namespace tet
