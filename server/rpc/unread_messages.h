// Messages that gRPC refuses before any call of ours sees them.
//
// They come from whoever reaches the port, with or without a token. None may cost more than the
// limit on a message, and none may go unnoticed.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <grpcpp/server_builder.h>
#include <grpcpp/support/server_interceptor.h>

#include "server/ops/metrics.h"

namespace tet {

/// Counts them for the metrics, and logs one a second as "unread_message". Thread-safe.
class UnreadMessages {
 public:
  /// One that was malformed, or that its client gave up.
  void count_unreadable(std::string_view method, std::string_view peer);
  std::vector<Reading> readings() const;

 private:
  std::atomic<std::uint64_t> unreadable_{0};
};

/// Makes the server that is built refuse calls that say their messages are compressed
/// (UNIMPLEMENTED). The builder overrides what kTransportSettings says of that; why is told
/// there.
void refuse_compression(grpc::ServerBuilder& builder);

/// For the builder of a server: tells `unread` of the calls with a single message that could
/// not be read, and their clients that it was MALFORMED. `unread` must outlive the server.
std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> watch_messages(
    UnreadMessages& unread);

/// gRPC logs what refuse_compression refuses, and tells nobody else: whether `message` of its
/// log is about that. Counts it, for all servers of the process, if so.
bool count_compressed(std::string_view message);

}  // namespace tet
