// What gRPC has to say, as log lines of ours.
#pragma once

namespace tet {

/// From now on gRPC's own messages (a TLS handshake that failed, say) are "grpc" events; one a
/// second at most, for strangers can cause them.
///
/// gRPC stops listening for good when a connection cannot be accepted, for want of a file
/// descriptor say. Then the process is sent a SIGTERM, so that it ends and can be started
/// again.
void log_grpc_messages();

/// Whether gRPC has stopped listening so.
bool stopped_listening() noexcept;

}  // namespace tet
