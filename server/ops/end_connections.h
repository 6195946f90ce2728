// Connections whose peers take nothing, when the server ends.
#pragma once

#include <string_view>

namespace tet {

/// Shuts down each connection that this process has accepted at `port`, or on the socket file
/// that was bound as `socket_path`, so that whoever reads or writes there goes on at once, with
/// an error. Who listens there goes on listening. 0 and an empty path are none.
///
/// gRPC 1.51 closes no connection while it writes to it, also where it cancels all calls
/// ("delayed close due to in-progress write"), and it does not say which connections it has.
///
/// Descriptors are found by their numbers: to be called when the server ends and opens few
/// others.
void end_connections(int port, std::string_view socket_path = {}) noexcept;

}  // namespace tet
