#include "client/command/arguments/mesh_input.h"

#include <optional>
#include <utility>

#include <absl/strings/str_cat.h>

#include "client/command/arguments/scene_input.h"
#include "client/command/arguments/surface_input.h"
#include "client/command/arguments/volume_file.h"
#include "client/command/process/abandonable.h"
#include "client/library/api/temporary_folder.h"
#include "core/vdb/openvdb/openvdb_part.h"
#include "proto/wire/sha256.h"

namespace tet {
namespace {

absl::StatusOr<ConversionReport> convert_surface(const MeshInput& input,
                                                 const std::string& vdb_path) {
  const absl::StatusOr<SurfaceInput> read = read_surface_input(input.path, input.surface);
  if (!read.ok()) return read.status();
  return with_openvdb([&](const OpenVdbPart& part) {
    return part.surface_to_vdb(read->surface, read->voxel_size, vdb_path, read->open);
  });
}

/// Checks --open of an input that is no surface.
absl::Status check_open(const MeshInput& input) {
  if (!input.surface.open) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--open is for surfaces, and ", input.path, " is none"));
}

}  // namespace

absl::Status check_mesh_input(const MeshInput& input) {
  if (is_surface_file(input.path)) {
    if (input.grids.empty()) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat("--grid ", input.grids.front(), ": a surface file has no grids"));
  }
  if (is_scene_file(input.path)) {
    if (!input.surface.voxel) return check_open(input);
    return absl::InvalidArgumentError("--voxel is for surfaces; a scene takes --spacing");
  }
  if (!is_volume_file(input.path)) {
    return absl::InvalidArgumentError(absl::StrCat("the input ", input.path, " must end in ",
                                                   kVolumeEndings,
                                                   ", .obj, .stl, .ply or .json"));
  }
  if (input.surface.voxel) {
    return absl::InvalidArgumentError(
        "--voxel is for surfaces; use --spacing to mesh a volume at another size");
  }
  return check_open(input);
}

std::string stored_grid_name(const std::string& text) {
  if (is_sha256_hex(text)) return name_of_grid(text);
  return digest_of_name(text).empty() ? "" : text;
}

absl::StatusOr<std::string> upload_input(MeshClient& client,
                                         const MeshInput& input,
                                         const UploadWatch& watch,
                                         const Cancellation& cancellation) {
  std::string path = input.path;
  std::optional<tetstream::TemporaryFolder> scratch;
  if (is_surface_file(path)) {
    absl::StatusOr<tetstream::TemporaryFolder> folder = tetstream::TemporaryFolder::make();
    if (!folder.ok()) return folder.status();
    path = folder->file("surface.vdb");
    scratch.emplace(*std::move(folder));
    const absl::StatusOr<ConversionReport> report = run_abandonable<ConversionReport>(
        [input, path] { return convert_surface(input, path); },
        [&] {
          if (watch.bytes) watch.bytes(0, 1);
        },
        cancellation);
    if (!report.ok()) return report.status();
    if (watch.converted) watch.converted(*report);
  }
  const ClientProgress progress{.upload = watch.bytes, .planning = {}, .tets = {}};
  return client.upload_file(path, progress, cancellation);
}

}  // namespace tet
