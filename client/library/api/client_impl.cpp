#include "client/library/api/client_impl.h"

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "client/library/api/core_request.h"
#include "client/library/api/labels_impl.h"
#include "client/library/api/scene_impl.h"
#include "client/library/api/temporary_folder.h"
#include "client/library/wire_request.h"
#include "core/image/write_labels.h"

namespace tetstream {
namespace {

/// The server's name of a field's values, which are uploaded where they have none.
absl::StatusOr<StoredVolume> stored_field(tet::MeshClient& meshes,
                                          const Field& field,
                                          const tet::Cancellation& cancellation) {
  if (field.stored) return *field.stored;
  if (!field.values) {
    return absl::InvalidArgumentError(absl::StrCat("fields: ", field.name, " has no values"));
  }
  auto name = upload_volume(meshes, *field.values, {}, cancellation);
  if (!name.ok()) return name.status();
  return StoredVolume{*std::move(name)};
}

/// The message without what it is about.
absl::StatusOr<v1::MeshRequest> bare_message(tet::MeshClient& meshes,
                                             const std::string& name,
                                             const std::vector<std::string>& grids,
                                             const Request& request,
                                             const tet::Cancellation& cancellation) {
  absl::StatusOr<tet::MeshRequest> core = core_request(request);
  if (!core.ok()) return core.status();
  for (std::size_t i = 0; i < core->fields.size(); ++i) {
    auto stored = stored_field(meshes, request.fields[i], cancellation);
    if (!stored.ok()) return stored.status();
    core->fields[i].file = std::move(stored->name);
    core->fields[i].grid = std::move(stored->grid);
  }
  return tet::wire_request(*core, name, grids);
}

}  // namespace

absl::StatusOr<std::string> upload_volume(tet::MeshClient& meshes,
                                          const Volume& volume,
                                          const tet::ClientProgress& progress,
                                          const tet::Cancellation& cancellation) {
  const absl::StatusOr<TemporaryFolder> folder = TemporaryFolder::make();
  if (!folder.ok()) return folder.status();
  const std::string path = folder->file("volume.vdb");
  if (const Status written = volume.write_vdb(path); !written.ok()) {
    return absl::Status(static_cast<absl::StatusCode>(written.code()), written.message());
  }
  return meshes.upload_file(path, progress, cancellation);
}

absl::StatusOr<std::string> upload_labels(tet::MeshClient& meshes,
                                          const Labels& labels,
                                          const tet::ClientProgress& progress,
                                          const tet::Cancellation& cancellation) {
  const absl::StatusOr<TemporaryFolder> folder = TemporaryFolder::make();
  if (!folder.ok()) return folder.status();
  const std::string path = folder->file("labels.nrrd");
  if (labels.impl().volume == nullptr) {
    return absl::FailedPreconditionError(
        "level sets are not uploaded one by one: upload the .vdb file that has them, and name "
        "them in StoredVolume::grids");
  }
  if (absl::Status s = tet::write_labels(*labels.impl().volume, path); !s.ok()) return s;
  return meshes.upload_file(path, progress, cancellation);
}

absl::StatusOr<v1::Scene> stored_scene(tet::MeshClient& meshes,
                                       const Scene& scene,
                                       const tet::Cancellation& cancellation) {
  std::map<std::string, std::string> stored;  // by the scene's own names
  for (const SceneGrid& grid : scene.impl().grids) {
    auto name = upload_volume(meshes, grid.volume, {}, cancellation);
    if (!name.ok()) return name.status();
    stored[grid.name] = *std::move(name);
  }
  v1::Scene message = scene.impl().message;
  for (v1::SceneNode& node : *message.mutable_nodes()) {
    if (!node.has_grid()) continue;
    const auto found = stored.find(node.grid().name());
    if (found != stored.end()) node.mutable_grid()->set_name(found->second);
  }
  return message;
}

absl::StatusOr<v1::MeshRequest> message_of(tet::MeshClient& meshes,
                                           const StoredVolume& volume,
                                           const Request& request,
                                           const tet::Cancellation& cancellation) {
  if (volume.grids.empty()) {
    std::vector<std::string> grids;
    if (!volume.grid.empty()) grids.push_back(volume.grid);
    return bare_message(meshes, volume.name, grids, request, cancellation);
  }
  if (!request.labels) {
    return absl::InvalidArgumentError(
        "grids are set, which are labels of one mesh: set the request's labels, too");
  }
  auto message = bare_message(meshes, volume.name, {}, request, cancellation);
  if (message.ok()) {
    message->mutable_grid_names()->Assign(volume.grids.begin(), volume.grids.end());
    if (!volume.grid.empty()) message->set_grid_name(volume.grid);
  }
  return message;
}

absl::StatusOr<v1::MeshRequest> message_of(tet::MeshClient& meshes,
                                           const Scene& scene,
                                           const Request& request,
                                           const tet::Cancellation& cancellation) {
  auto message = bare_message(meshes, "", {}, request, cancellation);
  if (!message.ok()) return message.status();
  auto stored = stored_scene(meshes, scene, cancellation);
  if (!stored.ok()) return stored.status();
  *message->mutable_scene() = *std::move(stored);
  return message;
}

}  // namespace tetstream
