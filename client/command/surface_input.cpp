#include "client/command/surface_input.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/files/surface_file.h"

namespace tet {
namespace {

/// Fine enough to show the shape, coarse enough to mesh in seconds.
constexpr double kVoxelsAlongLongestExtent = 128;

double longest_extent(const TriangleSurface& surface) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  WorldPoint low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const WorldPoint& p : surface.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

}  // namespace

bool is_surface_file(const std::string& path) {
  const std::string name = absl::AsciiStrToLower(path);
  return absl::EndsWith(name, ".obj") || absl::EndsWith(name, ".stl") ||
         absl::EndsWith(name, ".ply");
}

absl::StatusOr<SurfaceInput> read_surface_input(const std::string& path,
                                                std::optional<double> voxel_size) {
  absl::StatusOr<TriangleSurface> surface = read_surface(path);
  if (!surface.ok()) return surface.status();
  const double size =
      voxel_size ? *voxel_size : longest_extent(*surface) / kVoxelsAlongLongestExtent;
  return SurfaceInput{*std::move(surface), size};
}

std::string describe_conversion(const ConversionReport& report, double voxel_size) {
  std::string text =
      absl::StrFormat("%d vertices, %d triangles, ", report.vertices, report.triangles);
  if (report.closed) {
    absl::StrAppend(&text, "closed; made a level set of what it encloses");
  } else {
    absl::StrAppend(
        &text, "not closed (", report.open_edges,
        " open edges), so it has no inside; made a shell one voxel thick around it");
  }
  if (report.non_manifold_edges > 0) {
    absl::StrAppend(&text, " (", report.non_manifold_edges,
                    " edges have three or more triangles)");
  }
  return absl::StrCat(text, absl::StrFormat(", with voxels of %g, %d of them active",
                                            voxel_size, report.active_voxels));
}

}  // namespace tet
