// `tetstream health`: is a server serving?
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "client/command.h"
#include "client/mesh_client.h"
#include "client/server_options.h"

namespace tet {
namespace {

constexpr const char* kExamples = R"(
Exits with 0 when the server says that it is serving, and with 3 otherwise.

Example:
  tetstream health --server localhost:7447
  tetstream health --server mesher.example:7447 --tls
)";

absl::Status run_health(const ServerArguments& server, const Cancellation& interruption) {
  const auto channel = understand_server(server);
  if (!channel.ok()) return channel.status();
  const auto client = MeshClient::connect(server.address, *channel, {.attempts = 1});
  if (!client.ok()) return client.status();
  const absl::Status status = (*client)->check_health("readiness", interruption);
  // Whatever the answer was, it is the server that is not well.
  if (!status.ok()) return absl::UnavailableError(status.message());
  std::printf("%s: serving\n", server.address.c_str());
  return absl::OkStatus();
}

}  // namespace

Command add_health_command(CLI::App& app) {
  const auto server = std::make_shared<ServerArguments>();
  app.footer(kExamples);
  describe_server(app, *server)->required();
  return
      [server](const Cancellation& interruption) { return run_health(*server, interruption); };
}

}  // namespace tet
