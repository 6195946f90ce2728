// One StreamMesh call whose messages stay the bytes they came in.
#pragma once

#include <memory>
#include <string>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// "/tetstream.v1.MeshService/StreamMesh".
std::string stream_mesh_method();

/// What that call sends.
grpc::ByteBuffer stream_mesh_bytes(const v1::StreamMeshRequest& request);

/// The generated stub would parse every message, copying its columns into strings. Not
/// thread-safe; `context` outlives it.
class EventStream {
 public:
  EventStream(const std::shared_ptr<grpc::Channel>& channel,
              grpc::ClientContext& context,
              const v1::StreamMeshRequest& request);
  /// `finish` was called.
  ~EventStream();
  EventStream(const EventStream&) = delete;
  EventStream& operator=(const EventStream&) = delete;

  /// Waits for the next MeshEvent; false when there is none.
  bool read(grpc::ByteBuffer& event);

  /// Waits for the end of the call, which comes after the last `read` or a cancellation.
  grpc::Status finish();

 private:
  /// Waits for the operation that was begun; false when it failed.
  bool done();

  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

}  // namespace tet
