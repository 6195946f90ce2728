// What a public client holds, and how its requests become messages.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <absl/status/statusor.h>

#include "client/library/connection.h"
#include "client/library/job_client.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"
#include "tetstream/client.h"
#include "tetstream/labels.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"
#include "tetstream/v1/meshes.pb.h"

namespace tetstream {

struct Client::Impl {
  explicit Impl(std::shared_ptr<tet::Connection> connected)
      : connection(std::move(connected)),
        meshes(std::make_unique<tet::MeshClient>(connection)),
        jobs(std::make_unique<tet::JobClient>(connection)) {}

  const std::shared_ptr<tet::Connection> connection;
  const std::unique_ptr<tet::MeshClient> meshes;
  const std::unique_ptr<tet::JobClient> jobs;
};

/// Stores a volume by way of a temporary file, and returns its name.
absl::StatusOr<std::string> upload_volume(tet::MeshClient& meshes,
                                          const Volume& volume,
                                          const tet::ClientProgress& progress,
                                          const tet::Cancellation& cancellation);

/// Stores a segmentation in the same way.
absl::StatusOr<std::string> upload_labels(tet::MeshClient& meshes,
                                          const Labels& labels,
                                          const tet::ClientProgress& progress,
                                          const tet::Cancellation& cancellation);

/// The message, once the server has what it is about: fields and a scene's volumes are
/// uploaded.
absl::StatusOr<v1::MeshRequest> message_of(tet::MeshClient& meshes,
                                           const StoredVolume& volume,
                                           const Request& request,
                                           const tet::Cancellation& cancellation);
absl::StatusOr<v1::MeshRequest> message_of(tet::MeshClient& meshes,
                                           const Scene& scene,
                                           const Request& request,
                                           const tet::Cancellation& cancellation);

/// The scene with the names that the server has given its volumes.
absl::StatusOr<v1::Scene> stored_scene(tet::MeshClient& meshes,
                                       const Scene& scene,
                                       const tet::Cancellation& cancellation);

}  // namespace tetstream
