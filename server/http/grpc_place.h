// Where gRPC's port is, for the commands that the page shows.
#pragma once

#include <string>

namespace tet {

/// Returns `{"host": "mesher", "port": 7447, "tls": false}` for the address that gRPC's port
/// was opened as. The host is empty where that was every address of the machine: whoever asks
/// then knows a name of it, the one that the page came from. An address that is no host:port,
/// such as a socket file, is told as `{"address": "unix:/run/tetstream", "tls": false}`.
std::string grpc_place_json(const std::string& address, bool tls);

}  // namespace tet
