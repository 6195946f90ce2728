// Connections to a server, as all of our clients open them.
#pragma once

#include <memory>
#include <string>

#include <grpcpp/channel.h>

namespace tet {

/// A connection of its own, never shared with another channel of this process. Does not wait
/// for the server; a lost one is sought again after 0.1 to 3 seconds.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address);

}  // namespace tet
