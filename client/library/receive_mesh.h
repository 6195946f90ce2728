// A mesh from as many streams as it takes, whichever call they come from.
#pragma once

#include <functional>
#include <string>

#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/connection.h"
#include "client/library/event_stream.h"
#include "client/library/mesh_client.h"
#include "client/library/mesh_receiver.h"
#include "core/base/cancel.h"

namespace tet {

/// Takes all events of a call. Errors: those of EventStream::step.
absl::Status receive_stream(Connection& connection,
                            StreamCall call,
                            const Cancellation& cancellation);

/// A call whose events are a mesh, which a MeshReceiver takes.
struct MeshCall {
  std::string service, method;  ///< as in their .proto file
  /// The request for what `receiver` lacks.
  std::function<grpc::ByteBuffer(const MeshReceiver& receiver)> request;
  SharedChunks* shared = nullptr;  ///< where events may come beside the stream
};

/// Receives all of a mesh. Errors: those of receive_stream, and of MeshReceiver.
absl::StatusOr<StreamedMesh> receive_mesh(Connection& connection,
                                          const MeshCall& call,
                                          MeshReceiver receiver,
                                          const ClientProgress& progress,
                                          const Cancellation& cancellation);

}  // namespace tet
