#include "client/mesh_client.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "client/channel.h"
#include "client/client_call.h"
#include "client/local_file.h"
#include "client/mesh_receiver.h"
#include "client/raw_call.h"
#include "client/upload.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "proto/wire/serialized.h"
#include "proto/wire/transport.h"
#include "tetstream/v1/grids.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

namespace {

void tell(const std::function<void(std::uint64_t, std::uint64_t)>& listener,
          std::uint64_t done,
          std::uint64_t total) {
  if (listener) listener(done, total);
}

}  // namespace

struct MeshClient::Connection {
  Connection(ServerChannel server, RetryPolicy retry_policy)
      : retry(retry_policy), channel(std::move(server)) {}

  /// One unary call, tried again while the server is not to be reached.
  template <class Stub, class Request, class Response>
  absl::StatusOr<Response> call(Stub& stub,
                                grpc::Status (Stub::*method)(grpc::ClientContext*,
                                                             const Request&,
                                                             Response*),
                                const Request& request,
                                const Cancellation& cancellation) {
    for (Retries retries(retry, cancellation);;) {
      Response response;
      ClientCall attempt(channel, cancellation);
      const auto status =
          attempt.result((stub.*method)(&attempt.context(), request, &response));
      if (status.ok()) return response;
      if (!retries.again(status, 0)) return status;
    }
  }

  const RetryPolicy retry;
  const ServerChannel channel;
  v1::GridService::Stub grids{channel.channel()};
  v1::MeshService::Stub meshes{channel.channel()};
  grpc::health::v1::Health::Stub health{channel.channel()};
};

std::unique_ptr<MeshClient> MeshClient::connect(const std::string& address, RetryPolicy retry) {
  return std::unique_ptr<MeshClient>(
      new MeshClient(std::make_unique<Connection>(open_channel(address), retry)));
}

absl::StatusOr<std::unique_ptr<MeshClient>> MeshClient::connect(const std::string& address,
                                                                const ChannelOptions& options,
                                                                RetryPolicy retry) {
  auto channel = open_channel(address, options);
  if (!channel.ok()) return channel.status();
  return std::unique_ptr<MeshClient>(
      new MeshClient(std::make_unique<Connection>(*std::move(channel), retry)));
}

MeshClient::MeshClient(std::unique_ptr<Connection> connection)
    : connection_(std::move(connection)) {}

MeshClient::~MeshClient() = default;

absl::StatusOr<std::string> MeshClient::upload_file(const std::string& path,
                                                    const ClientProgress& progress,
                                                    const Cancellation& cancellation) {
  auto& grids = connection_->grids;
  const auto file = name_file(path, cancellation);
  if (!file.ok()) return file.status();
  v1::FindMissingGridsRequest find;
  find.add_names(file->name);
  const auto missing =
      connection_->call(grids, &v1::GridService::Stub::FindMissingGrids, find, cancellation);
  if (!missing.ok()) return missing.status();
  if (missing->missing_names().empty()) return file->name;

  v1::GetUploadStatusRequest ask;
  ask.set_name(file->name);
  for (Retries retries(connection_->retry, cancellation);;) {
    const auto state =
        connection_->call(grids, &v1::GridService::Stub::GetUploadStatus, ask, cancellation);
    if (!state.ok()) return state.status();
    if (state->complete()) return file->name;
    const auto offset = static_cast<std::uint64_t>(state->committed_size());
    const auto status =
        upload_from(connection_->channel, *file, offset, progress, cancellation);
    if (status.ok()) return file->name;
    if (!retries.again(status, offset)) return status;
  }
}

absl::StatusOr<std::vector<v1::GridFile>> MeshClient::list_grids(
    const Cancellation& cancellation) {
  std::vector<v1::GridFile> files;
  v1::ListGridsRequest request;
  do {
    auto page = connection_->call(connection_->grids, &v1::GridService::Stub::ListGrids,
                                  request, cancellation);
    if (!page.ok()) return page.status();
    for (v1::GridFile& file : *page->mutable_files()) files.push_back(std::move(file));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return files;
}

absl::StatusOr<v1::GridFile> MeshClient::grid_info(const std::string& name,
                                                   const Cancellation& cancellation) {
  v1::GetGridInfoRequest request;
  request.set_name(name);
  return connection_->call(connection_->grids, &v1::GridService::Stub::GetGridInfo, request,
                           cancellation);
}

absl::StatusOr<v1::Capabilities> MeshClient::capabilities(const Cancellation& cancellation) {
  return connection_->call(connection_->meshes, &v1::MeshService::Stub::GetCapabilities,
                           v1::GetCapabilitiesRequest(), cancellation);
}

absl::StatusOr<v1::MeshHeader> MeshClient::estimate(const v1::MeshRequest& request,
                                                    const Cancellation& cancellation) {
  v1::EstimateMeshRequest message;
  *message.mutable_mesh() = request;
  return connection_->call(connection_->meshes, &v1::MeshService::Stub::EstimateMesh, message,
                           cancellation);
}

absl::Status MeshClient::check_health(const std::string& service,
                                      const Cancellation& cancellation) {
  using grpc::health::v1::HealthCheckResponse;
  grpc::health::v1::HealthCheckRequest request;
  request.set_service(service);
  const auto health = connection_->call(
      connection_->health, &grpc::health::v1::Health::Stub::Check, request, cancellation);
  if (!health.ok()) return health.status();
  if (health->status() == HealthCheckResponse::SERVING) return absl::OkStatus();
  return absl::UnavailableError(
      absl::StrCat("health is ", HealthCheckResponse::ServingStatus_Name(health->status())));
}

namespace {

/// One stream, from the first chunk that is missing on.
absl::Status receive(const ServerChannel& channel,
                     v1::StreamMeshRequest message,
                     const ClientProgress& progress,
                     const Cancellation& cancellation,
                     MeshReceiver& receiver) {
  message.set_start_chunk(static_cast<std::int64_t>(receiver.next_chunk()));
  message.set_expected_mesh_id(receiver.mesh_id());
  ClientCall call(channel, cancellation);
  RawCall stream(channel.channel(), call.context(), v1::MeshService::service_full_name(),
                 "StreamMesh");
  stream.write_last(serialized(message));
  absl::Status taken;
  for (grpc::ByteBuffer event; taken.ok() && stream.read(event);) {
    taken = receiver.take(event);
    if (const auto& planning = receiver.planning()) {
      tell(progress.planning, static_cast<std::uint64_t>(planning->done_bricks()),
           static_cast<std::uint64_t>(planning->total_bricks()));
    } else {
      tell(progress.tets, receiver.tets_received(), receiver.tet_count());
    }
  }
  if (!taken.ok()) call.context().TryCancel();
  const absl::Status ended = call.result(stream.finish());
  if (!taken.ok()) return taken;
  if (!ended.ok() || receiver.complete()) return ended;
  return absl::UnavailableError("the stream ended before the mesh was whole");
}

}  // namespace

absl::StatusOr<StreamedMesh> MeshClient::stream_mesh(const v1::MeshRequest& request,
                                                     const ClientProgress& progress,
                                                     const Cancellation& cancellation,
                                                     v1::Encoding encoding) {
  v1::StreamMeshRequest message;
  *message.mutable_mesh() = request;
  message.set_encoding(encoding);
  return receive_mesh(std::move(message), MeshReceiver(), progress, cancellation);
}

absl::StatusOr<StreamedMesh> MeshClient::update_mesh(const v1::MeshRequest& request,
                                                     const StreamedMesh& earlier,
                                                     const ClientProgress& progress,
                                                     const Cancellation& cancellation) {
  v1::StreamMeshRequest message;
  *message.mutable_mesh() = request;
  message.set_base_mesh_id(earlier.mesh_id);
  message.set_base_name(earlier.canonical_request.name());
  return receive_mesh(std::move(message), MeshReceiver(&earlier.mesh), progress, cancellation);
}

absl::StatusOr<StreamedMesh> MeshClient::receive_mesh(v1::StreamMeshRequest message,
                                                      MeshReceiver receiver,
                                                      const ClientProgress& progress,
                                                      const Cancellation& cancellation) {
  for (Retries retries(connection_->retry, cancellation);;) {
    const auto status =
        receive(connection_->channel, message, progress, cancellation, receiver);
    if (receiver.complete()) return std::move(receiver).finish(cancellation);
    if (!retries.again(status, receiver.next_chunk())) return status;
  }
}

}  // namespace tet
