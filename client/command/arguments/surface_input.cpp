#include "client/command/arguments/surface_input.h"

#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "core/surface/default_voxel.h"
#include "core/triangle_files/surface_file.h"

namespace tet {

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
