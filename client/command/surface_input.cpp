#include "client/command/surface_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "core/files/surface_file.h"
#include "core/surface/orient_surface.h"

namespace tet {
namespace {

constexpr double kVoxelsAlongLongestExtent = 128;
constexpr double kVoxelsAcrossWalls = 2.5;

/// Walls are not resolved at the cost of more voxels than these, which take a few seconds.
constexpr double kMostBandVoxels = 2e7, kBandVoxels = 7;

double longest_extent(const TriangleSurface& surface) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  WorldPoint low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const WorldPoint& p : surface.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

/// A plate of a surface's area, on both sides of it, and volume.
struct PlateLike {
  double area = 0;
  double thickness = 0;  ///< 0 of a surface that encloses nothing
};

PlateLike plate_of(const TriangleSurface& surface) {
  PlateLike plate;
  if (surface.triangles.empty()) return plate;
  double six = 0;
  for (const auto& t : surface.triangles) {
    six += six_volume(surface, t, surface.vertices[surface.triangles[0][0]]);
    plate.area += twice_area(surface, t) / 2;
  }
  if (plate.area > 0) plate.thickness = std::abs(six / 3 / plate.area);
  return plate;
}

}  // namespace

bool is_surface_file(const std::string& path) {
  const std::string name = absl::AsciiStrToLower(path);
  return absl::EndsWith(name, ".obj") || absl::EndsWith(name, ".stl") ||
         absl::EndsWith(name, ".ply");
}

void describe_surface(CLI::App& app, SurfaceChoices& choices) {
  app.add_option("--voxel", choices.voxel, "Voxel size for a surface [longest extent / 128]");
  app.add_option_function<std::string>(
         "--open",
         [&choices](const std::string& word) {
           choices.open = word == "shell"   ? OpenSurface::kShell
                          : word == "close" ? OpenSurface::kClose
                                            : OpenSurface::kRefuse;
         },
         "A surface with holes: refuse it, close them, or make a shell around it [refuse]")
      ->check(CLI::IsMember({"refuse", "close", "shell"}));
}

double default_voxel(const TriangleSurface& surface) {
  const double voxel = longest_extent(surface) / kVoxelsAlongLongestExtent;
  const PlateLike plate = plate_of(surface);
  if (!(plate.thickness > 0)) return voxel;
  const double least = std::sqrt(kBandVoxels * plate.area / kMostBandVoxels);
  return std::min(voxel, std::max(plate.thickness / kVoxelsAcrossWalls, least));
}

absl::StatusOr<SurfaceInput> read_surface_input(const std::string& path,
                                                const SurfaceChoices& choices) {
  absl::StatusOr<TriangleSurface> surface = read_surface(path);
  if (!surface.ok()) return surface.status();
  const double size = choices.voxel ? *choices.voxel : default_voxel(*surface);
  return SurfaceInput{*std::move(surface), size, choices.open.value_or(OpenSurface::kRefuse)};
}

std::string describe_conversion(const ConversionReport& report) {
  std::string text = report.text();
  for (const std::string& warning : report.warnings()) {
    absl::StrAppend(&text, "\nwarning: ", warning);
  }
  return text;
}

}  // namespace tet
