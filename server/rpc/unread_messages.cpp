#include "server/rpc/unread_messages.h"

#include <string>

#include <absl/strings/match.h>

#include "proto/convert/status.h"
#include "server/ops/logging.h"
#include "server/ops/sieve.h"
#include "server/rpc/forwarded.h"

namespace tet {

namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::InterceptorBatchMethods;
using grpc::experimental::ServerRpcInfo;

std::atomic<std::uint64_t> compressed_messages{0};

void log_unread(const char* why, nlohmann::ordered_json fields) {
  static Sieve sieve;
  const auto left_out = sieve.pass();
  if (!left_out) return;
  fields["why"] = why;
  fields["left_out"] = *left_out;
  log_event(spdlog::level::warn, "unread_message", fields);
}

absl::Status unreadable() {
  return with_reason(
      absl::InvalidArgumentError("the message is not one that this method takes"), "MALFORMED");
}

/// Watches one call whose client sends one message.
class MessageWatch final : public grpc::experimental::Interceptor {
 public:
  MessageWatch(ServerRpcInfo& call, UnreadMessages& unread) : call_(call), unread_(unread) {}

  void Intercept(InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_MESSAGE) &&
        methods->GetRecvMessage() == nullptr) {
      unread_.count_unreadable(call_.method(), peer_of(*call_.server_context()).address);
      unread_one_ = true;
    }
    // gRPC itself would say UNIMPLEMENTED, without a word.
    if (unread_one_ &&
        methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
      methods->ModifySendStatus(to_grpc(unreadable()));
    }
    methods->Proceed();
  }

 private:
  ServerRpcInfo& call_;
  UnreadMessages& unread_;
  bool unread_one_ = false;
};

/// In a stream of messages one that cannot be read is the stream's end, and its call's affair.
class MessageWatches final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit MessageWatches(UnreadMessages& unread) : unread_(unread) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(ServerRpcInfo* call) override {
    using Type = ServerRpcInfo::Type;
    const bool one = call->type() == Type::UNARY || call->type() == Type::SERVER_STREAMING;
    return one ? new MessageWatch(*call, unread_) : nullptr;
  }

 private:
  UnreadMessages& unread_;
};

}  // namespace

void UnreadMessages::count_unreadable(std::string_view method, std::string_view peer) {
  ++unreadable_;
  log_unread("unreadable", {{"method", method}, {"peer", peer}});
}

std::vector<Reading> UnreadMessages::readings() const {
  constexpr char kName[] = "tetstream_unread_messages_total";
  constexpr char kHelp[] = "Messages refused before they were read, by why.";
  return {counter(kName, kHelp, compressed_messages.load(), {{"why", "compressed"}}),
          counter(kName, kHelp, unreadable_.load(), {{"why", "unreadable"}})};
}

void refuse_compression(grpc::ServerBuilder& builder) {
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_DEFLATE, false);
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_GZIP, false);
}

std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> watch_messages(
    UnreadMessages& unread) {
  return std::make_unique<MessageWatches>(unread);
}

bool count_compressed(std::string_view message) {
  const absl::string_view text(message.data(), message.size());
  if (!absl::StartsWith(text, "Compression algorithm '") ||
      !absl::EndsWith(text, "' is disabled.")) {
    return false;
  }
  ++compressed_messages;
  log_unread("compressed", {{"message", message}});
  return true;
}

}  // namespace tet
