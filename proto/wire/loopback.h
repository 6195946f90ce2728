// Which addresses never leave the machine.
#pragma once

#include <string_view>

namespace tet {

/// Whether an address, "host:port" or one of gRPC's "unix:" ones, can be reached from this
/// machine alone: 127.0.0.0/8, ::1, "localhost" or a socket file. Any other name is not,
/// whatever it resolves to.
bool is_loopback(std::string_view address) noexcept;

}  // namespace tet
