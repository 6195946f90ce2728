// What the settings say of where a server listens, and who can reach it there.
#pragma once

#include <sys/types.h>

#include <absl/status/status.h>

#include "server/ops/config.h"

namespace tet {

/// Errors: kInvalidArgument (nowhere to listen, or a file for a port that there is none of).
absl::Status check_listening(const Config& config);

/// The rights that the socket file is to have.
mode_t socket_rights(const Config& config);

/// Logs each place where anyone may call, or what is sent can be read on its way.
void warn_if_exposed(const Config& config);

}  // namespace tet
