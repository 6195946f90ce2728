// A mesh from as many streams as it takes, whichever call they come from.
#pragma once

#include <functional>
#include <string>

#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/connection.h"
#include "client/mesh_client.h"
#include "client/mesh_receiver.h"
#include "core/base/cancel.h"

namespace tet {

/// A call that is answered with a stream of MeshEvents.
struct MeshCall {
  std::string service, method;  ///< as in their .proto file
  /// The request for what `receiver` lacks.
  std::function<grpc::ByteBuffer(const MeshReceiver& receiver)> request;
};

/// Receives all of a mesh; a stream that breaks is resumed at the first chunk that is missing.
/// Errors: the server's own, and those of MeshReceiver.
absl::StatusOr<StreamedMesh> receive_mesh(Connection& connection,
                                          const MeshCall& call,
                                          MeshReceiver receiver,
                                          const ClientProgress& progress,
                                          const Cancellation& cancellation);

}  // namespace tet
