// What gRPC and protobuf have to say, as log lines of ours.
#pragma once

namespace tet {

/// From now on gRPC's own messages (a TLS handshake that failed, say) are "grpc" events, and
/// protobuf's (text that is no UTF-8) "protobuf" events; one a second at most, for strangers
/// can cause them. Left alone, both write to standard error themselves, and wait for whoever
/// reads it.
///
/// gRPC stops listening for good when a connection cannot be accepted, for want of a file
/// descriptor say. Then the process is sent a SIGTERM, so that it ends and can be started
/// again.
void log_grpc_messages();

/// Whether gRPC has stopped listening so.
bool stopped_listening() noexcept;

}  // namespace tet
