// Handlers of calls that throw before they have answered.
#pragma once

#include <memory>
#include <set>
#include <string>

#include <grpcpp/support/server_interceptor.h>

namespace tet {

/// For the builder of a server that has these services, by their full names. gRPC drops what a
/// handler throws and answers UNIMPLEMENTED, without a word to anybody; with these the client
/// is told INTERNAL, and the log the method.
std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> watch_handlers(
    std::set<std::string> services);

}  // namespace tet
