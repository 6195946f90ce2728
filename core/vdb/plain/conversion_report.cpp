#include "core/vdb/plain/conversion_report.h"

#include <cmath>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

namespace tet {
namespace {

std::string counted(std::uint64_t count, const char* one, const char* many) {
  return absl::StrFormat("%d %s", count, count == 1 ? one : many);
}

std::string holes_of(const ConversionReport& report) {
  return absl::StrFormat("%s in %s of up to %.3g",
                         counted(report.open_edges, "open edge", "open edges"),
                         counted(report.holes, "hole", "holes"), report.widest_hole);
}

std::string what_was_made(const ConversionReport& report) {
  switch (report.kind) {
    case ConvertedTo::kSolid:
      return "closed; made a level set of what it encloses";
    case ConvertedTo::kMendedSolid:
      return absl::StrCat("closed but for ", holes_of(report),
                          ", which were capped; made a level set of what it encloses");
    case ConvertedTo::kClosedSolid:
      return absl::StrCat("not closed (", holes_of(report),
                          "); closed with caps as asked, and made a level set of what it then "
                          "encloses");
    case ConvertedTo::kShell:
      return absl::StrCat("not closed (", holes_of(report),
                          "), so it has no inside; made a shell two voxels thick around it as "
                          "asked");
  }
  return "";
}

/// What was put right in passing.
std::vector<std::string> repairs_of(const ConversionReport& report) {
  std::vector<std::string> repairs;
  const auto add = [&](std::uint64_t count, const char* one, const char* many) {
    if (count > 0) repairs.push_back(counted(count, one, many));
  };
  add(report.doubled_triangles, "doubled triangle left out", "doubled triangles left out");
  add(report.turned_triangles, "triangle turned round to fit its neighbours",
      "triangles turned round to fit their neighbours");
  add(report.turned_bodies, "body turned round that was wound inside out",
      "bodies turned round that were wound inside out");
  add(report.non_manifold_edges, "edge has three or more triangles",
      "edges have three or more triangles");
  if (report.overlaps) {
    repairs.push_back("solids that overlap or lie within one another count as one");
  }
  return repairs;
}

}  // namespace

const char* name_of(ConvertedTo kind) noexcept {
  switch (kind) {
    case ConvertedTo::kSolid:
      return "solid";
    case ConvertedTo::kMendedSolid:
      return "mended solid";
    case ConvertedTo::kClosedSolid:
      return "closed solid";
    case ConvertedTo::kShell:
      return "shell";
  }
  return "";
}

std::string ConversionReport::text() const {
  const std::vector<std::string> repairs = repairs_of(*this);
  return absl::StrCat(
      absl::StrFormat("%d vertices, %d triangles, ", vertices, triangles), what_was_made(*this),
      repairs.empty() ? "" : absl::StrCat(" (", absl::StrJoin(repairs, "; "), ")"),
      absl::StrFormat(", with voxels of %g, %d of them active", voxel_size, active_voxels));
}

double ConversionReport::volume_tolerance(double spacing) const noexcept {
  // Edges lose about a tenth of the square of the spacing per length, and no surface has more
  // of them than its area over a few spacings, but for what its voxels do not resolve.
  return 0.05 * spacing * area;
}

std::vector<std::string> ConversionReport::warnings() const {
  std::vector<std::string> warnings;
  if (lost_bodies > 0) {
    warnings.push_back(absl::StrFormat(
        "%s too small for voxels of %g and lost: use smaller voxels to have them",
        counted(lost_bodies, "body or cavity is", "bodies or cavities are"), voxel_size));
  }
  if (hidden_walls + hidden_gaps > 0) {
    warnings.push_back(
        absl::StrFormat("%s and %s of the surface are thinner than a voxel of %g and pass "
                        "between voxel centres: "
                        "use smaller voxels to have them",
                        counted(hidden_walls, "spot of walls", "spots of walls"),
                        counted(hidden_gaps, "of gaps", "of gaps"), voxel_size));
  }
  if (surface_volume && std::abs(volume - *surface_volume) > volume_tolerance(voxel_size)) {
    warnings.push_back(absl::StrFormat(
        "the level set has a volume of %.6g, and the surface of %.6g: voxels of %g do not "
        "resolve it",
        volume, *surface_volume, voxel_size));
  }
  return warnings;
}

std::string open_surface_refusal(const ConversionReport& report) {
  return absl::StrFormat(
      "the surface is not closed: %s, together %.3g %% of its area, so it has no inside. Close "
      "it; or choose --open close (caps over the holes) or --open shell (a solid two voxels "
      "thick around it)",
      holes_of(report), 100 * report.hole_area / report.area);
}

}  // namespace tet
