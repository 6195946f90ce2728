// The servers that a client may ask: one at a time, and the next when that one is gone.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/library/channel.h"
#include "client/library/client_call.h"
#include "client/library/shared_chunks_pool.h"

namespace tet {

/// Thread safety: any thread may call any member.
class Connection {
 public:
  /// `address` is host:port or unix:PATH, or several with commas between. Does not wait for any
  /// of them.
  /// Errors: those of open_channel.
  static absl::StatusOr<std::shared_ptr<Connection>> open(const std::string& address,
                                                          const ChannelOptions& options,
                                                          RetryPolicy retry = {});

  /// The server that answered last, until it cannot be reached.
  const ServerChannel& server() const { return servers_[turn_.load() % servers_.size()]; }

  /// Shared memory for streams, of whichever server.
  SharedChunksPool& shared_chunks() noexcept { return shared_chunks_; }

  Retries begin(const Cancellation& cancellation) const { return {retry_, cancellation}; }

  /// Some server has answered, if only with the beginning of a stream: it is there, and calls
  /// that it breaks off are taken up more often.
  void answered() noexcept { known_.store(true, std::memory_order_relaxed); }

  /// OK where a call that failed at `failed` is worth another attempt, at the next server if
  /// that one cannot be reached; else why the call ends, as Retries::again has it.
  absl::Status again(Retries& retries,
                     const ServerChannel& failed,
                     const absl::Status& status,
                     std::uint64_t progress);

  /// One unary call, tried again while the server is not to be reached.
  template <class Stub, class Request, class Response>
  absl::StatusOr<Response> call(grpc::Status (Stub::*method)(grpc::ClientContext*,
                                                             const Request&,
                                                             Response*),
                                const Request& request,
                                const Cancellation& cancellation) {
    for (Retries retries = begin(cancellation);;) {
      Response response;
      const ServerChannel& asked = server();
      Stub stub(asked.channel());
      ClientCall attempt(asked, cancellation);
      const auto status =
          attempt.result((stub.*method)(&attempt.context(), request, &response));
      if (status.ok()) {
        answered();
        return response;
      }
      if (auto ended = again(retries, asked, status, 0); !ended.ok()) return ended;
    }
  }

 private:
  Connection(std::vector<ServerChannel> servers, RetryPolicy retry)
      : retry_(retry), servers_(std::move(servers)) {}

  const RetryPolicy retry_;
  const std::vector<ServerChannel> servers_;
  std::atomic<std::size_t> turn_{0};
  std::atomic<bool> known_{false};  ///< a server has answered
  SharedChunksPool shared_chunks_;
};

}  // namespace tet
