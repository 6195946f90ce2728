// A call of our own gRPC services, made within the process for somebody who spoke HTTP.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/client_callback.h>

#include "server/http/event_loop.h"
#include "server/http/grpc_web.h"
#include "server/rpc/forwarded.h"

namespace tet {

/// What a call's answer goes to; told on the loop's thread.
class CallSink {
 public:
  virtual ~CallSink() = default;
  /// A message came. The next one is read when the sink asks for it.
  virtual void on_message(grpc::ByteBuffer message) = 0;
  /// The message that was written is on its way.
  virtual void on_written() = 0;
  /// The last that is told.
  virtual void on_end(const grpc::Status& status, const Trailers& trailers) = 0;
};

/// What a call is made with.
struct CallOrder {
  std::string method;  ///< "/tetstream.v1.MeshService/StreamMesh"
  ForwardedPeer peer;
  std::optional<std::chrono::nanoseconds> timeout;
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// One call, from the loop's thread, where all of its members are called and its sink is told.
/// The limits, the log and the refusals are the service's own: this is a client like others.
class ForwardedCall final : public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                            public std::enable_shared_from_this<ForwardedCall> {
 public:
  ForwardedCall(EventLoop& loop, CallSink& sink) : loop_(loop), sink_(&sink) {}

  /// Begins the call, and reads the first message of its answer.
  void start(const CallOrder& order, const std::shared_ptr<grpc::GenericStub>& stub);
  /// Sends a message; the next one may follow when that is told to be written.
  void write(grpc::ByteBuffer message, bool last);
  void read();
  /// Ends the call as if its client had gone; the sink is told nothing more.
  void abandon();

 private:
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  void release();

  EventLoop& loop_;
  CallSink* sink_;  ///< null once it was abandoned
  std::shared_ptr<grpc::GenericStub> stub_;
  std::shared_ptr<ForwardedCall> self_;  ///< until gRPC is done
  grpc::ClientContext context_;
  grpc::ByteBuffer outgoing_, incoming_;
  bool held_ = false;     ///< gRPC waits with OnDone, as more may be read or written
  bool reading_ = false;  ///< a read is under way
};

}  // namespace tet
