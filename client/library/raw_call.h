// A streaming call whose messages are bytes: what the generated stubs would copy stays where it
// is.
#pragma once

#include <memory>
#include <string>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

namespace tet {

/// One call, one operation at a time but for a read that `can_read` has begun, on the thread
/// that waits for it. Not thread-safe; `context` outlives it.
class RawCall {
 public:
  /// `method` of `service`, as in their .proto file. Nothing is sent before the first message.
  RawCall(const std::shared_ptr<grpc::Channel>& channel,
          grpc::ClientContext& context,
          const std::string& service,
          const std::string& method);
  /// `finish` was called.
  ~RawCall();
  RawCall(const RawCall&) = delete;
  RawCall& operator=(const RawCall&) = delete;

  /// False when the server takes no more; `finish` tells why.
  bool write(const grpc::ByteBuffer& message);
  /// Writes the last message that there is. False when the server takes no more.
  bool write_last(const grpc::ByteBuffer& message);
  bool writes_done();

  /// Waits for the next message; false when there is none.
  bool read(grpc::ByteBuffer& message);
  /// Whether `read` would not wait.
  bool can_read();

  /// Waits for the end of the call, which comes after the last `read`, a failed `write`, or a
  /// cancellation.
  grpc::Status finish();

 private:
  /// Waits for the operation that was begun; false when it failed.
  bool done();
  void begin_read();

  grpc::ByteBuffer incoming_;  ///< of the read that was begun
  bool reading_ = false, has_read_ = false, read_ok_ = false;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

}  // namespace tet
