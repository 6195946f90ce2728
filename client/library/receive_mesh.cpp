#include "client/library/receive_mesh.h"

#include <utility>

namespace tet {

namespace {

void tell(const std::function<void(std::uint64_t, std::uint64_t)>& listener,
          std::uint64_t done,
          std::uint64_t total) {
  if (listener) listener(done, total);
}

}  // namespace

absl::Status receive_stream(Connection& connection,
                            StreamCall call,
                            const Cancellation& cancellation) {
  EventStream events(connection, std::move(call), cancellation);
  for (;;) {
    const absl::StatusOr<bool> more = events.step();
    if (!more.ok()) return more.status();
    if (!*more) return absl::OkStatus();
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
       [&] { return receiver.complete(); }, [&] { return receiver.next_chunk(); }, call.shared},
      cancellation);
  if (!received.ok()) return received;
  return std::move(receiver).finish(cancellation);
}

}  // namespace tet
