#include "client/library/receive_mesh.h"

#include <utility>

#include "client/library/raw_call.h"

namespace tet {

namespace {

void tell(const std::function<void(std::uint64_t, std::uint64_t)>& listener,
          std::uint64_t done,
          std::uint64_t total) {
  if (listener) listener(done, total);
}

/// One stream, from the first chunk that is missing on.
absl::Status receive_once(const ServerChannel& channel,
                          const StreamCall& what,
                          const Cancellation& cancellation) {
  ClientCall call(channel, cancellation);
  RawCall stream(channel.channel(), call.context(), what.service, what.method);
  stream.write_last(what.request());
  absl::Status taken;
  for (grpc::ByteBuffer event; taken.ok() && stream.read(event);) taken = what.take(event);
  if (!taken.ok()) call.context().TryCancel();
  absl::Status ended = call.result(stream.finish());
  if (!taken.ok()) return taken;
  if (!ended.ok() || what.complete()) return ended;
  return absl::UnavailableError("the stream ended before all of it had come");
}

}  // namespace

absl::Status receive_stream(Connection& connection,
                            const StreamCall& call,
                            const Cancellation& cancellation) {
  for (Retries retries = connection.begin(cancellation);;) {
    const ServerChannel& server = connection.server();
    absl::Status status = receive_once(server, call, cancellation);
    if (call.complete()) return absl::OkStatus();
    if (!connection.again(retries, server, status, call.next_chunk())) return status;
  }
}

absl::StatusOr<StreamedMesh> receive_mesh(Connection& connection,
                                          const MeshCall& call,
                                          MeshReceiver receiver,
                                          const ClientProgress& progress,
                                          const Cancellation& cancellation) {
  const auto take = [&](grpc::ByteBuffer& event) {
    absl::Status taken = receiver.take(event);
    if (const auto& planning = receiver.planning()) {
      tell(progress.planning, static_cast<std::uint64_t>(planning->done_bricks()),
           static_cast<std::uint64_t>(planning->total_bricks()));
    } else {
      tell(progress.tets, receiver.tets_received(), receiver.tet_count());
    }
    return taken;
  };
  const absl::Status received = receive_stream(
      connection,
      {call.service, call.method, [&] { return call.request(receiver); }, take,
       [&] { return receiver.complete(); }, [&] { return receiver.next_chunk(); }},
      cancellation);
  if (!received.ok()) return received;
  return std::move(receiver).finish(cancellation);
}

}  // namespace tet
