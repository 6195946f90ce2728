// A call that is answered with a stream of MeshEvents, taken one by one over as many
// connections as it takes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/client_call.h"
#include "client/library/connection.h"
#include "client/library/shared_chunks.h"
#include "core/base/cancel.h"

namespace tet {

/// A call that is answered with a stream of MeshEvents, and whoever takes them.
struct StreamCall {
  std::string service, method;                ///< as in their .proto file
  std::function<grpc::ByteBuffer()> request;  ///< for what is missing
  std::function<absl::Status(grpc::ByteBuffer&)> take;
  std::function<bool()> complete;
  std::function<std::uint64_t()> next_chunk;  ///< the first that is missing
  /// Where events may come beside the stream: see SharedChunks, whose this is.
  SharedChunks* shared = nullptr;
};

/// Nothing is read but by `step`: between two steps the transport's buffers fill up, and then
/// the server waits. A stream that breaks is resumed at the first chunk that is missing. Not
/// thread-safe, but may be used by one thread after another.
class EventStream {
 public:
  /// `connection` and `cancellation` outlive this.
  EventStream(Connection& connection, StreamCall call, const Cancellation& cancellation);
  /// Has the server stop, unless it has.
  ~EventStream();

  /// Waits for one more event, which is taken; false where the call is complete and has ended.
  /// The call begins with the first step. Errors, after which there is nothing more: the
  /// server's own, and those of `take`.
  absl::StatusOr<bool> step();

 private:
  struct Attempt;

  void begin();
  bool next(grpc::ByteBuffer& event);
  absl::Status end_attempt();

  Connection& connection_;
  const StreamCall call_;
  const Cancellation& cancellation_;
  Retries retries_;
  std::unique_ptr<Attempt> attempt_;
};

}  // namespace tet
