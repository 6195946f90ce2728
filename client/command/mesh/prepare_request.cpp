#include "client/command/mesh/prepare_request.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/command/arguments/mesh_input.h"
#include "client/command/arguments/request_options.h"
#include "client/command/arguments/scene_input.h"
#include "client/command/mesh/grid_uploads.h"
#include "client/library/wire_request.h"
#include "core/base/printable.h"

namespace tet {
namespace {

absl::StatusOr<std::string> upload(GridUploads& uploads,
                                   const MeshInput& input,
                                   ProgressBar& bar,
                                   const Cancellation& interruption,
                                   std::optional<ConversionReport>* surface = nullptr) {
  bar.begin("uploading", "B");
  const UploadWatch watch{
      .bytes =
          [&](std::uint64_t done, std::uint64_t total) {
            bar.update(static_cast<double>(done), static_cast<double>(total));
          },
      .converted =
          [&](const ConversionReport& report) {
            bar.say_lines(for_terminal(input.path) + ": " + describe_conversion(report),
                          stderr);
            if (surface != nullptr) *surface = report;
          }};
  return uploads.name_of(input, watch, interruption);
}

/// Grids of sizes and fields in files of their own go up, too: paths become names.
absl::Status upload_others(GridUploads& uploads,
                           MeshRequest& request,
                           ProgressBar& bar,
                           const Cancellation& interruption) {
  std::vector<std::string*> files;
  if (request.sizing.grid) files.push_back(&request.sizing.grid->file);
  for (VertexField& field : request.fields) files.push_back(&field.file);
  for (std::string* const file : files) {
    if (file->empty()) continue;
    absl::StatusOr<std::string> name = upload(uploads, {*file, {}, {}}, bar, interruption);
    if (!name.ok()) return name.status();
    *file = *std::move(name);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PreparedRequest> prepare_request(MeshClient& client,
                                                const MeshOptions& options,
                                                ProgressBar& bar,
                                                const Cancellation& interruption) {
  GridUploads uploads(client);
  MeshRequest named = options.request;
  if (auto status = upload_others(uploads, named, bar, interruption); !status.ok()) {
    return status;
  }
  if (is_scene_file(options.input)) {
    const auto store = [&](const std::string& path) {
      return upload(uploads, {path, {}, {}}, bar, interruption);
    };
    absl::StatusOr<v1::Scene> scene = read_scene_message(options.input, store);
    if (!scene.ok()) return scene.status();
    v1::MeshRequest request = wire_request(named, "", {});
    *request.mutable_scene() = *std::move(scene);
    return PreparedRequest{std::move(request), std::nullopt};
  }
  PreparedRequest prepared;
  const absl::StatusOr<std::string> name =
      upload(uploads, {options.input, options.grids, options.surface}, bar, interruption,
             &prepared.surface);
  if (!name.ok()) return name.status();
  prepared.message = wire_request(named, *name, options.grids);
  if (!options.all_grids) return prepared;
  const auto grids = client.meshable_grids(*name, interruption);
  if (!grids.ok()) return grids.status();
  if (auto status = check_all_grids(options.input, *grids); !status.ok()) return status;
  prepared.message.mutable_grid_names()->Assign(grids->begin(), grids->end());
  return prepared;
}

}  // namespace tet
