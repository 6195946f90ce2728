#include "client/library/remesh_session.h"

#include <optional>
#include <utility>

#include "client/library/mesh_receiver.h"
#include "client/library/raw_call.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

RemeshSession::RemeshSession(Connection& connection, const Cancellation& cancellation)
    : cancellation_(cancellation),
      call_(connection.server(), cancellation),
      stream_(std::make_unique<RawCall>(connection.server().channel(),
                                        call_.context(),
                                        v1::MeshService::service_full_name(),
                                        "RemeshSession")) {}

RemeshSession::~RemeshSession() {
  if (ended_) return;
  call_.context().TryCancel();
  stream_->finish();
}

absl::StatusOr<std::unique_ptr<RemeshSession>> RemeshSession::begin(
    Connection& connection, const v1::MeshRequest& request, const Cancellation& cancellation) {
  std::unique_ptr<RemeshSession> session(new RemeshSession(connection, cancellation));
  v1::RemeshRequest message;
  *message.mutable_start() = request;
  if (auto status = session->exchange(message); !status.ok()) return status;
  return session;
}

absl::Status RemeshSession::update(const v1::Scene& scene) {
  v1::RemeshRequest message;
  *message.mutable_frame()->mutable_scene() = scene;
  return exchange(message);
}

absl::Status RemeshSession::update(const std::vector<v1::LeafUpdate>& leaves) {
  v1::RemeshRequest message;
  message.mutable_frame()->mutable_leaves()->Assign(leaves.begin(), leaves.end());
  return exchange(message);
}

absl::Status RemeshSession::exchange(const v1::RemeshRequest& message) {
  if (ended_) return absl::FailedPreconditionError("the session is over: begin another");
  if (!stream_->write(serialized(message))) return broken();
  MeshReceiver receiver(mesh_.mesh_id.empty() ? nullptr : &mesh_.mesh, std::move(used_));
  if (auto status = receive(receiver); !status.ok()) return status;
  tets_sent_ = receiver.tets_sent();
  auto mesh = std::move(receiver).finish(cancellation_);
  if (!mesh.ok()) return mesh.status();
  used_ = std::exchange(mesh_, *std::move(mesh)).mesh;
  return absl::OkStatus();
}

absl::Status RemeshSession::receive(MeshReceiver& receiver) {
  while (!receiver.complete()) {
    grpc::ByteBuffer event;
    if (!stream_->read(event)) return broken();
    const absl::Status taken = receiver.take(event);
    if (taken.ok()) continue;
    // What the server says of a call that we give up is that it was given up.
    call_.context().TryCancel();
    broken().IgnoreError();
    return taken;
  }
  return absl::OkStatus();
}

absl::Status RemeshSession::end() {
  if (ended_) return absl::OkStatus();
  stream_->writes_done();
  ended_ = true;
  return call_.result(stream_->finish());
}

/// Why there is nothing more to read.
absl::Status RemeshSession::broken() {
  ended_ = true;
  const absl::Status status = call_.result(stream_->finish());
  return status.ok() ? absl::UnavailableError("the server ended the session") : status;
}

}  // namespace tet
