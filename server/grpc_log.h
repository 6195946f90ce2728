// What gRPC has to say, as log lines of ours.
#pragma once

namespace tet {

/// From now on gRPC's own messages (a TLS handshake that failed, say) are "grpc" events; one a
/// second at most, for strangers can cause them.
void log_grpc_messages();

}  // namespace tet
