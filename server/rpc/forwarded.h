// Calls that the HTTP port makes within this process, for somebody else.
#pragma once

#include <string>

#include <grpcpp/client_context.h>
#include <grpcpp/server_context.h>

namespace tet {

/// Who is behind a forwarded call.
struct ForwardedPeer {
  std::string address;  ///< as gRPC writes it: "ipv4:10.0.0.7:51234"
  std::string subject;  ///< of the client's certificate; empty without one
};

/// Says for whom the call is made. What it says is believed because a random number comes with
/// it that never leaves this process: whoever calls over the network cannot know it.
void forward_for(const ForwardedPeer& peer, grpc::ClientContext& context);

/// Returns the peer for whom the call is made; that of the transport where it is no forwarded
/// one.
ForwardedPeer peer_of(const grpc::ServerContextBase& context);

}  // namespace tet
