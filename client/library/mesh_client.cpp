#include "client/library/mesh_client.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "client/library/attached_image.h"
#include "client/library/connection.h"
#include "client/library/local_file.h"
#include "client/library/mesh_receiver.h"
#include "client/library/receive_mesh.h"
#include "client/library/remesh_session.h"
#include "client/library/served_chunks.h"
#include "client/library/served_samples.h"
#include "client/library/upload.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/grids.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

std::unique_ptr<MeshClient> MeshClient::connect(const std::string& address, RetryPolicy retry) {
  return *connect(address, {}, retry);  // which only files and tokens can make fail
}

absl::StatusOr<std::unique_ptr<MeshClient>> MeshClient::connect(const std::string& address,
                                                                const ChannelOptions& options,
                                                                RetryPolicy retry) {
  auto connection = Connection::open(address, options, retry);
  if (!connection.ok()) return connection.status();
  return std::make_unique<MeshClient>(*std::move(connection));
}

MeshClient::MeshClient(std::shared_ptr<Connection> connection)
    : connection_(std::move(connection)) {}

MeshClient::~MeshClient() = default;

absl::StatusOr<std::string> MeshClient::upload_file(const std::string& path,
                                                    const ClientProgress& progress,
                                                    const Cancellation& cancellation) {
  const absl::StatusOr<AttachedImage> attached = AttachedImage::of(path, cancellation);
  if (!attached.ok()) return attached.status();
  const auto file = name_file(attached->path(), cancellation);
  if (!file.ok()) return file.status();
  v1::FindMissingGridsRequest find;
  find.add_names(file->name);
  const auto missing =
      connection_->call(&v1::GridService::Stub::FindMissingGrids, find, cancellation);
  if (!missing.ok()) return missing.status();
  if (missing->missing_names().empty()) return file->name;

  v1::GetUploadStatusRequest ask;
  ask.set_name(file->name);
  for (Retries retries = connection_->begin(cancellation);;) {
    const auto state =
        connection_->call(&v1::GridService::Stub::GetUploadStatus, ask, cancellation);
    if (!state.ok()) return state.status();
    if (state->complete()) return file->name;
    const auto offset = static_cast<std::uint64_t>(state->committed_size());
    const ServerChannel& server = connection_->server();
    const auto status = upload_from(server, *file, offset, progress, cancellation);
    if (status.ok()) return file->name;
    if (auto ended = connection_->again(retries, server, status, offset); !ended.ok())
      return ended;
  }
}

absl::StatusOr<std::vector<v1::GridFile>> MeshClient::list_grids(
    const Cancellation& cancellation) {
  std::vector<v1::GridFile> files;
  v1::ListGridsRequest request;
  do {
    auto page = connection_->call(&v1::GridService::Stub::ListGrids, request, cancellation);
    if (!page.ok()) return page.status();
    for (v1::GridFile& file : *page->mutable_files()) files.push_back(std::move(file));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return files;
}

absl::StatusOr<v1::GridFile> MeshClient::grid_info(const std::string& name,
                                                   const Cancellation& cancellation,
                                                   GridDetail detail) {
  v1::GetGridInfoRequest request;
  request.set_name(name);
  request.set_values(detail == GridDetail::kValues);
  return connection_->call(&v1::GridService::Stub::GetGridInfo, request, cancellation);
}

absl::StatusOr<std::vector<std::string>> MeshClient::meshable_grids(
    const std::string& name, const Cancellation& cancellation) {
  const auto file = grid_info(name, cancellation);
  if (!file.ok()) return file.status();
  std::vector<std::string> names;
  for (const v1::GridInfo& grid : file->grids()) {
    if (grid.not_meshable_reason().empty()) names.push_back(grid.name());
  }
  return names;
}

absl::StatusOr<v1::Capabilities> MeshClient::capabilities(const Cancellation& cancellation) {
  return connection_->call(&v1::MeshService::Stub::GetCapabilities,
                           v1::GetCapabilitiesRequest(), cancellation);
}

absl::StatusOr<v1::MeshHeader> MeshClient::estimate(const v1::MeshRequest& request,
                                                    const Cancellation& cancellation) {
  v1::EstimateMeshRequest message;
  *message.mutable_mesh() = request;
  return connection_->call(&v1::MeshService::Stub::EstimateMesh, message, cancellation);
}

absl::Status MeshClient::check_health(const std::string& service,
                                      const Cancellation& cancellation) {
  using grpc::health::v1::HealthCheckResponse;
  grpc::health::v1::HealthCheckRequest request;
  request.set_service(service);
  const auto health =
      connection_->call(&grpc::health::v1::Health::Stub::Check, request, cancellation);
  if (!health.ok()) return health.status();
  if (health->status() == HealthCheckResponse::SERVING) return absl::OkStatus();
  return absl::UnavailableError(
      absl::StrCat("health is ", HealthCheckResponse::ServingStatus_Name(health->status())));
}

namespace {

v1::StreamMeshRequest stream_request(const v1::MeshRequest& request,
                                     const StreamOptions& options) {
  v1::StreamMeshRequest message;
  *message.mutable_mesh() = request;
  message.set_encoding(options.encoding);
  message.set_skip_cache(options.skip_cache);
  return message;
}

absl::StatusOr<StreamedMesh> receive_stream_mesh(Connection& connection,
                                                 v1::StreamMeshRequest message,
                                                 MeshReceiver receiver,
                                                 const ClientProgress& progress,
                                                 const Cancellation& cancellation) {
  const PooledSharedChunks shared(connection.shared_chunks());
  receiver.use_shared(*shared, cancellation);
  const auto request = [&](const MeshReceiver& so_far) {
    message.set_start_chunk(static_cast<std::int64_t>(so_far.next_chunk()));
    message.set_expected_mesh_id(so_far.mesh_id());
    if (so_far.is_sent_whole()) {
      // A base is of no more use, and would have the stream refused while it cannot be had.
      message.clear_base_mesh_id();
      message.clear_base_name();
    }
    shared->ask(message, connection.server().shared_memory_path(), cancellation);
    return serialized(message);
  };
  auto mesh = receive_mesh(
      connection, {v1::MeshService::service_full_name(), "StreamMesh", request, &*shared},
      std::move(receiver), progress, cancellation);
  if (mesh.ok()) shared->rest();
  return mesh;
}

}  // namespace

absl::StatusOr<StreamedMesh> MeshClient::stream_mesh(const v1::MeshRequest& request,
                                                     const ClientProgress& progress,
                                                     const Cancellation& cancellation,
                                                     StreamOptions options) {
  return receive_stream_mesh(*connection_, stream_request(request, options),
                             MeshReceiver(nullptr, std::move(options.used)), progress,
                             cancellation);
}

std::unique_ptr<ChunkSupply> MeshClient::stream_chunks(const v1::MeshRequest& request,
                                                       const ClientProgress& progress,
                                                       const Cancellation& cancellation,
                                                       const StreamOptions& options) {
  return std::make_unique<ServedChunks>(connection_, stream_request(request, options), progress,
                                        cancellation);
}

absl::StatusOr<StreamedMesh> MeshClient::update_mesh(const v1::MeshRequest& request,
                                                     const StreamedMesh& earlier,
                                                     const ClientProgress& progress,
                                                     const Cancellation& cancellation,
                                                     StreamOptions options) {
  v1::StreamMeshRequest message = stream_request(request, options);
  message.set_base_mesh_id(earlier.mesh_id);
  message.set_base_name(earlier.canonical_request.name());
  return receive_stream_mesh(*connection_, std::move(message),
                             MeshReceiver(&earlier.mesh, std::move(options.used)), progress,
                             cancellation);
}

absl::StatusOr<PointSamples> MeshClient::sample_points(
    const v1::MeshRequest& request,
    std::span<const WorldPoint> points,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress,
    const Cancellation& cancellation) {
  return sample_there(*connection_, request, points, progress, cancellation);
}

absl::StatusOr<std::unique_ptr<RemeshSession>> MeshClient::begin_session(
    const v1::MeshRequest& request, const Cancellation& cancellation, SessionIds ids) {
  return RemeshSession::begin(connection_, request, cancellation, ids);
}

}  // namespace tet
