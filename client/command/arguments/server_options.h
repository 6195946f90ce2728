// The options that say which server to ask, and how, as every command takes them.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "client/library/channel.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tet {

/// What a command line says of the server, before it is understood.
struct ServerArguments {
  std::string address;
  ChannelOptions channel;
  std::string token_file;
};

/// Adds --server, --tls, --tls-ca, --tls-cert, --tls-key, --token-file, --token-in-plain
/// and --no-shared-memory; returns --server.
CLI::Option* describe_server(CLI::App& app, ServerArguments& arguments);

/// Reads the token. Errors: kNotFound (no such file), kInvalidArgument (not a token).
absl::StatusOr<ChannelOptions> understand_server(const ServerArguments& arguments);

}  // namespace tet
