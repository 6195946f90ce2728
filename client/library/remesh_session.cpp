#include "client/library/remesh_session.h"

#include <cstddef>
#include <utility>

#include "client/library/mesh_receiver.h"
#include "client/library/raw_call.h"
#include "client/library/stable_chunks.h"
#include "client/library/stream_checks.h"
#include "client/library/stream_reader.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

namespace {

/// Every server takes messages of 2 MiB.
constexpr std::size_t kPartBytes = std::size_t{1} << 20;
/// What a leaf takes in a message beside its own bytes, at most.
constexpr std::size_t kLeafOverhead = 8;

}  // namespace

RemeshSession::RemeshSession(std::shared_ptr<Connection> connection,
                             const ServerChannel& server,
                             const Cancellation& cancellation,
                             SessionIds ids)
    : connection_(std::move(connection)),
      cancellation_(cancellation),
      shared_memory_path_(server.shared_memory_path()),
      shared_(connection_->shared_chunks()),
      call_(server, cancellation),
      stream_(std::make_unique<RawCall>(server.channel(),
                                        call_.context(),
                                        v1::MeshService::service_full_name(),
                                        "RemeshSession")) {
  if (ids == SessionIds::kStable) stable_ = std::make_unique<StableMesh>();
}

RemeshSession::~RemeshSession() {
  if (ended_) return;
  call_.context().TryCancel();
  stream_->finish();
}

absl::StatusOr<std::unique_ptr<RemeshSession>> RemeshSession::begin(
    const std::shared_ptr<Connection>& connection,
    const v1::MeshRequest& request,
    const Cancellation& cancellation,
    SessionIds ids) {
  v1::RemeshRequest message;
  *message.mutable_start() = request;
  message.set_tell_refusals(true);
  message.set_loose_patches(true);
  // Before its first mesh has come there is nothing to lose: a connection that broke, as one
  // that the server closed while nobody used it, is no more the end of it than of any other
  // call.
  for (Retries retries = connection->begin(cancellation);;) {
    const ServerChannel& asked = connection->server();
    std::unique_ptr<RemeshSession> session(
        new RemeshSession(connection, asked, cancellation, ids));
    session->shared_->ask(message, session->shared_memory_path_, cancellation);
    const absl::Status begun = session->exchange(message);
    if (begun.ok()) {
      connection->answered();
      return session;
    }
    session.reset();
    if (auto ended = connection->again(retries, asked, begun, 0); !ended.ok()) return ended;
  }
}

absl::Status RemeshSession::update(const v1::Scene& scene) {
  v1::RemeshRequest message;
  *message.mutable_frame()->mutable_scene() = scene;
  return exchange(message);
}

absl::Status RemeshSession::update(const std::vector<v1::LeafUpdate>& leaves) {
  v1::RemeshFrame part;
  std::size_t bytes = 0;
  for (const v1::LeafUpdate& leaf : leaves) {
    const std::size_t more = leaf.ByteSizeLong() + kLeafOverhead;
    if (bytes > 0 && bytes + more > kPartBytes) {
      v1::RemeshRequest message;
      message.mutable_part()->Swap(&part);
      if (auto sent = send(message); !sent.ok()) return sent;
      part.Clear();
      bytes = 0;
    }
    *part.add_leaves() = leaf;
    bytes += more;
  }
  v1::RemeshRequest message;
  message.mutable_frame()->Swap(&part);
  return exchange(message);
}

absl::Status RemeshSession::send(const v1::RemeshRequest& message) {
  if (ended_) return absl::FailedPreconditionError("the session is over: begin another");
  return stream_->write(serialized(message)) ? absl::OkStatus() : broken();
}

/// What is thrown for want of memory leaves a frame that is half taken.
absl::Status RemeshSession::exchange(const v1::RemeshRequest& message) {
  try {
    return take_frame(message);
  } catch (...) {
    if (!ended_) give_up(absl::OkStatus()).IgnoreError();
    throw;
  }
}

absl::Status RemeshSession::take_frame(const v1::RemeshRequest& message) {
  if (auto sent = send(message); !sent.ok()) return sent;
  if (stable_) return patch();
  MeshReceiver receiver(mesh_.mesh_id.empty() ? nullptr : &mesh_.mesh, std::move(used_),
                        /*loose=*/true);
  if (auto status = receive(receiver); !status.ok()) return status;
  if (!receiver.refusal().ok()) {
    const absl::Status refusal = receiver.refusal();
    used_ = std::move(receiver).take_used();
    return refusal;
  }
  tets_sent_ = receiver.tets_sent();
  auto mesh = std::move(receiver).finish(cancellation_);
  if (!mesh.ok()) return give_up(mesh.status());
  used_ = std::exchange(mesh_, *std::move(mesh)).mesh;
  return absl::OkStatus();
}

/// The mesh becomes the next one where it lies.
absl::Status RemeshSession::patch() {
  StableChunks chunks(*stable_);
  StreamReader reader(
      chunks, mesh_.mesh_id.empty() ? StreamReader::Base::kNone : StreamReader::Base::kFrame);
  if (auto status = receive(reader); !status.ok()) return status;
  if (!reader.refusal().ok()) return reader.refusal();
  if (reader.compact()) return give_up(bad_stream("compact chunks in a session"));
  tets_sent_ = reader.tets_sent();
  mesh_ = std::move(reader.told());
  return absl::OkStatus();
}

/// Until the mesh is whole, or its frame refused.
template <class Receiver>
absl::Status RemeshSession::receive(Receiver& receiver) {
  receiver.use_shared(*shared_, cancellation_);
  while (!receiver.complete() && receiver.refusal().ok()) {
    grpc::ByteBuffer event;
    const bool beside =
        shared_->take_event(event, cancellation_, [&] { return stream_->can_read(); });
    // What is left beside the stream comes before what is in it.
    if (!beside && cancellation_.requested()) return give_up(check_cancelled(cancellation_));
    if (!beside && !stream_->read(event)) return broken();
    if (auto taken = receiver.take(event); !taken.ok()) return give_up(std::move(taken));
  }
  shared_->pause();
  return absl::OkStatus();
}

/// What the server says of a call that we give up is that it was given up.
absl::Status RemeshSession::give_up(absl::Status why) {
  call_.context().TryCancel();
  broken().IgnoreError();
  return why;
}

absl::Status RemeshSession::end() {
  if (ended_) return absl::OkStatus();
  stream_->writes_done();
  ended_ = true;
  absl::Status ended = call_.result(stream_->finish());
  if (ended.ok()) shared_->rest();
  return ended;
}

/// Why there is nothing more to read.
absl::Status RemeshSession::broken() {
  ended_ = true;
  const absl::Status status = call_.result(stream_->finish());
  return status.ok() ? absl::UnavailableError("the server ended the session") : status;
}

}  // namespace tet
