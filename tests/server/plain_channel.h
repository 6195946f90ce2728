// A way to a server without what our own client asks of gRPC.
#pragma once

#include <memory>
#include <string>

#include <grpcpp/create_channel.h>

namespace tet::test {

/// A window that stays as it is. gRPC would widen it by how long answers take, up to as much as
/// a whole mesh: beside other work a stream that nobody reads came to its end.
inline grpc::ChannelArguments fixed_window() {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 1 << 20);
  return arguments;
}

inline std::shared_ptr<grpc::Channel> plain_channel(const std::string& address) {
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), fixed_window());
}

}  // namespace tet::test
