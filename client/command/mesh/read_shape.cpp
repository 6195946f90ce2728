#include "client/command/mesh/read_shape.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/command/arguments/request_options.h"
#include "client/command/arguments/scene_input.h"
#include "client/command/arguments/surface_input.h"
#include "client/command/process/abandonable.h"
#include "client/library/read_grids.h"
#include "core/base/parallel.h"
#include "core/base/printable.h"
#include "core/vdb/openvdb/openvdb_part.h"

namespace tet {
namespace {

FileTrust trust(const MeshOptions& options) {
  return options.trust ? FileTrust::kFull : FileTrust::kNone;
}

absl::StatusOr<SurfaceVolume> convert_file(const std::string& path,
                                           const SurfaceChoices& choices) {
  const absl::StatusOr<SurfaceInput> input = read_surface_input(path, choices);
  if (!input.ok()) return input.status();
  return with_openvdb([&](const OpenVdbPart& part) {
    return part.surface_to_volume(input->surface, input->voxel_size, input->open);
  });
}

/// The thread that converts has a pool of its own.
absl::StatusOr<ReadShape> convert_surface(const MeshOptions& options,
                                          ProgressBar& bar,
                                          const Cancellation& interruption) {
  bar.begin("converting");
  const auto work = [path = options.input, choices = options.surface,
                     threads = options.threads] {
    absl::StatusOr<SurfaceVolume> converted = absl::UnknownError("not converted");
    TaskPool pool(threads);
    pool.run([&] { converted = convert_file(path, choices); });
    return converted;
  };
  absl::StatusOr<SurfaceVolume> converted = run_abandonable<SurfaceVolume>(
      work, [&] { bar.update(0, 0); }, interruption);
  if (!converted.ok()) return converted.status();
  bar.say_lines(for_terminal(options.input) + ": " + describe_conversion(converted->report),
                stderr);
  return ReadShape{std::make_shared<const Volume>(std::move(converted->volume)),
                   converted->report};
}

absl::StatusOr<Volume> read_grid(const MeshOptions& options, const Cancellation& interruption) {
  return read_volume(options.input, options.grids.empty() ? "" : options.grids.front(),
                     trust(options), interruption);
}

/// A segmentation in a grid's place.
absl::StatusOr<LabelVolume> read_segmentation(const MeshOptions& options,
                                              const Cancellation& interruption) {
  return read_labels(options.input, options.grids.empty() ? "" : options.grids.front(),
                     trust(options), interruption);
}

absl::StatusOr<std::vector<std::string>> names_of_grids(const MeshOptions& options,
                                                        const Cancellation& interruption) {
  if (!options.all_grids) return options.grids;
  const auto listed = read_grid_list(options.input, trust(options), interruption);
  if (!listed.ok()) return listed.status();
  std::vector<std::string> names = meshable_of(*listed);
  if (auto status = check_all_grids(options.input, names); !status.ok()) return status;
  return names;
}

absl::StatusOr<Shape> read_several(const MeshOptions& options,
                                   ProgressBar& bar,
                                   const Cancellation& interruption) {
  const auto names = names_of_grids(options, interruption);
  if (!names.ok()) return names.status();
  GridList grids;
  for (const std::string& name : *names) {
    absl::StatusOr<Volume> volume =
        read_volume(options.input, name, trust(options), interruption);
    if (!volume.ok()) return volume.status();
    grids.push_back(std::make_shared<const Volume>(*std::move(volume)));
    bar.update(static_cast<double>(grids.size()), static_cast<double>(names->size()));
  }
  return grids;
}

/// Takes what was read.
template <class Input>
absl::StatusOr<Shape> shared(absl::StatusOr<Input> read) {
  if (!read.ok()) return read.status();
  return std::make_shared<const Input>(*std::move(read));
}

/// A shape that was no surface.
absl::StatusOr<ReadShape> alone(absl::StatusOr<Shape> shape) {
  if (!shape.ok()) return shape.status();
  return ReadShape{*std::move(shape), std::nullopt};
}

absl::Status read_sizes(const MeshOptions& options,
                        const Cancellation& interruption,
                        Sizing& sizing) {
  auto& grid = sizing.grid;
  if (!grid) return absl::OkStatus();
  absl::StatusOr<Volume> volume = read_volume(grid->file.empty() ? options.input : grid->file,
                                              grid->name, trust(options), interruption);
  if (!volume.ok()) return volume.status();
  grid->volume = std::make_shared<const Volume>(*std::move(volume));
  return absl::OkStatus();
}

/// The first component says how many there are.
absl::Status read_components(const MeshOptions& options,
                             const Cancellation& interruption,
                             VertexField& field) {
  std::uint32_t count = 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    absl::StatusOr<Volume> volume = read_field(field.file.empty() ? options.input : field.file,
                                               field.grid, i, trust(options), interruption);
    if (!volume.ok()) return volume.status();
    count = components_of(volume->kind);
    field.components.push_back(std::make_shared<const Volume>(*std::move(volume)));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ReadShape> read_shape(const MeshOptions& options,
                                     ProgressBar& bar,
                                     const Cancellation& interruption) {
  bar.begin("reading");
  const auto read = [&](const std::string& path, const std::string& grid_name) {
    return read_volume(path, grid_name, trust(options), interruption);
  };
  if (options.has_several_grids()) return alone(read_several(options, bar, interruption));
  if (options.request.labels && !is_scene_file(options.input)) {
    return alone(shared(read_segmentation(options, interruption)));
  }
  if (is_surface_file(options.input)) return convert_surface(options, bar, interruption);
  return alone(is_scene_file(options.input) ? shared(read_scene(options.input, read))
                                            : shared(read_grid(options, interruption)));
}

absl::StatusOr<MeshRequest> read_request(const MeshOptions& options,
                                         const Cancellation& interruption) {
  MeshRequest request = options.request;
  absl::Status status = read_sizes(options, interruption, request.sizing);
  for (VertexField& field : request.fields) {
    if (status.ok()) status = read_components(options, interruption, field);
  }
  if (!status.ok()) return status;
  return request;
}

}  // namespace tet
