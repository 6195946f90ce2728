#include "client/receive_mesh.h"

#include <utility>

#include "client/raw_call.h"

namespace tet {

namespace {

void tell(const std::function<void(std::uint64_t, std::uint64_t)>& listener,
          std::uint64_t done,
          std::uint64_t total) {
  if (listener) listener(done, total);
}

/// One stream, from the first chunk that is missing on.
absl::Status receive(const ServerChannel& channel,
                     const MeshCall& mesh_call,
                     const ClientProgress& progress,
                     const Cancellation& cancellation,
                     MeshReceiver& receiver) {
  ClientCall call(channel, cancellation);
  RawCall stream(channel.channel(), call.context(), mesh_call.service, mesh_call.method);
  stream.write_last(mesh_call.request(receiver));
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

absl::StatusOr<StreamedMesh> receive_mesh(Connection& connection,
                                          const MeshCall& call,
                                          MeshReceiver receiver,
                                          const ClientProgress& progress,
                                          const Cancellation& cancellation) {
  for (Retries retries = connection.begin(cancellation);;) {
    const ServerChannel& server = connection.server();
    const auto status = receive(server, call, progress, cancellation, receiver);
    if (receiver.complete()) return std::move(receiver).finish(cancellation);
    if (!connection.again(retries, server, status, receiver.next_chunk())) return status;
  }
}

}  // namespace tet
