// A mesh from as many streams as it takes, whichever call they come from.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/connection.h"
#include "client/library/mesh_client.h"
#include "client/library/mesh_receiver.h"
#include "core/base/cancel.h"

namespace tet {

/// A call that is answered with a stream of MeshEvents, and whoever takes them.
struct StreamCall {
  std::string service, method;                ///< as in their .proto file
  std::function<grpc::ByteBuffer()> request;  ///< for what is missing
  std::function<absl::Status(grpc::ByteBuffer&)> take;
  std::function<bool()> complete;
  std::function<std::uint64_t()> next_chunk;  ///< the first that is missing
};

/// Receives until the call is complete; a stream that breaks is resumed at the first chunk that
/// is missing. Errors: the server's own, and those of `take`.
absl::Status receive_stream(Connection& connection,
                            const StreamCall& call,
                            const Cancellation& cancellation);

/// A call whose events are a mesh, which a MeshReceiver takes.
struct MeshCall {
  std::string service, method;  ///< as in their .proto file
  /// The request for what `receiver` lacks.
  std::function<grpc::ByteBuffer(const MeshReceiver& receiver)> request;
};

/// Receives all of a mesh. Errors: those of receive_stream, and of MeshReceiver.
absl::StatusOr<StreamedMesh> receive_mesh(Connection& connection,
                                          const MeshCall& call,
                                          MeshReceiver receiver,
                                          const ClientProgress& progress,
                                          const Cancellation& cancellation);

}  // namespace tet
