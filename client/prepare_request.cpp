#include "client/prepare_request.h"

#include <string>
#include <utility>

#include "client/mesh_input.h"
#include "client/request_options.h"
#include "client/scene_input.h"

namespace tet {
namespace {

absl::StatusOr<std::string> upload(MeshClient& client,
                                   const MeshInput& input,
                                   ProgressBar& bar,
                                   const Cancellation& interruption) {
  bar.begin("uploading", "B");
  const UploadWatch watch{.bytes =
                              [&](std::uint64_t done, std::uint64_t total) {
                                bar.update(static_cast<double>(done),
                                           static_cast<double>(total));
                              },
                          .say = [&](const std::string& line) { bar.say(line); }};
  return upload_input(client, input, watch, interruption);
}

/// A sizing's grid in a file of its own goes up, too.
absl::Status upload_sizes(MeshClient& client,
                          MeshRequest& request,
                          ProgressBar& bar,
                          const Cancellation& interruption) {
  auto& grid = request.sizing.grid;
  if (!grid || grid->file.empty()) return absl::OkStatus();
  absl::StatusOr<std::string> name =
      upload(client, {grid->file, grid->name, {}}, bar, interruption);
  if (!name.ok()) return name.status();
  grid->file = *std::move(name);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::MeshRequest> prepare_request(MeshClient& client,
                                                const MeshOptions& options,
                                                ProgressBar& bar,
                                                const Cancellation& interruption) {
  MeshRequest sized = options.request;
  if (auto status = upload_sizes(client, sized, bar, interruption); !status.ok()) return status;
  if (is_scene_file(options.input)) {
    const auto store = [&](const std::string& path) {
      return upload(client, {path, "", {}}, bar, interruption);
    };
    absl::StatusOr<v1::Scene> scene = read_scene_message(options.input, store);
    if (!scene.ok()) return scene.status();
    v1::MeshRequest request = wire_request(sized, "", "");
    *request.mutable_scene() = *std::move(scene);
    return request;
  }
  const absl::StatusOr<std::string> name =
      upload(client, {options.input, options.grid, options.voxel}, bar, interruption);
  if (!name.ok()) return name.status();
  return wire_request(sized, *name, options.grid);
}

}  // namespace tet
