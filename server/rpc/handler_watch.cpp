#include "server/rpc/handler_watch.h"

#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <google/protobuf/descriptor.h>

#include "proto/convert/status.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::Interceptor;
using grpc::experimental::InterceptorBatchMethods;
using grpc::experimental::ServerInterceptorFactoryInterface;
using grpc::experimental::ServerRpcInfo;

/// Watches one call of a method that we have: none of ours says UNIMPLEMENTED.
class HandlerWatch final : public Interceptor {
 public:
  explicit HandlerWatch(ServerRpcInfo& call) : call_(call) {}

  void Intercept(InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS) &&
        methods->GetSendStatus().error_code() == grpc::StatusCode::UNIMPLEMENTED) {
      log_event(spdlog::level::err, "exception",
                {{"where", call_.method()}, {"what", "dropped by gRPC"}});
      methods->ModifySendStatus(to_grpc(
          with_reason(absl::InternalError(absl::StrCat("the server failed in ", call_.method(),
                                                       ": report it with the request's id")),
                      "INTERNAL")));
    }
    methods->Proceed();
  }

 private:
  ServerRpcInfo& call_;
};

/// For methods that there are: UNIMPLEMENTED is the right word for all others.
class HandlerWatches final : public ServerInterceptorFactoryInterface {
 public:
  explicit HandlerWatches(std::set<std::string> services) : services_(std::move(services)) {}

  Interceptor* CreateServerInterceptor(ServerRpcInfo* call) override {
    return is_there(call->method()) ? new HandlerWatch(*call) : nullptr;
  }

 private:
  /// `path` is "/service/method".
  bool is_there(const std::string& path) const {
    const std::vector<std::string> parts = absl::StrSplit(path, '/');
    if (parts.size() != 3 || !services_.contains(parts[1])) return false;
    return google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(
               absl::StrCat(parts[1], ".", parts[2])) != nullptr;
  }

  const std::set<std::string> services_;
};

}  // namespace

std::unique_ptr<ServerInterceptorFactoryInterface> watch_handlers(
    std::set<std::string> services) {
  return std::make_unique<HandlerWatches>(std::move(services));
}

}  // namespace tet
