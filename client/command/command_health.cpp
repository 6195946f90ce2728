// `tetstream health`: is a server serving?
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "client/command/arguments/server_options.h"
#include "client/command/command.h"
#include "client/library/mesh_client.h"
#include "core/base/printable.h"

namespace tet {
namespace {

constexpr const char* kHealthExamples = R"(
Exits with 0 when the server says that it is serving, and with 3 otherwise.

Example:
  tetstream health --server localhost:7447
  tetstream health --server mesher.example:7447 --tls
  tetstream health --server localhost:7447 --service jobs
)";

struct HealthArguments {
  ServerArguments server;
  std::string service = "readiness";
};

absl::Status run_health(const HealthArguments& arguments, const Cancellation& interruption) {
  const ServerArguments& server = arguments.server;
  const auto channel = understand_server(server);
  if (!channel.ok()) return channel.status();
  const auto client = MeshClient::connect(server.address, *channel, {.attempts = 1});
  if (!client.ok()) return client.status();
  const absl::Status status = (*client)->check_health(arguments.service, interruption);
  // Whatever the answer was, it is the server that is not well.
  if (!status.ok()) return absl::UnavailableError(status.message());
  std::printf("%s: serving\n", for_terminal(server.address).c_str());
  return absl::OkStatus();
}

}  // namespace

Command add_health_command(CLI::App& app) {
  const auto arguments = std::make_shared<HealthArguments>();
  app.footer(kHealthExamples);
  app.add_option("--service", arguments->service,
                 "What is asked after: readiness, liveness, or jobs [readiness]");
  describe_server(app, arguments->server)->required();
  return [arguments](const Cancellation& interruption) {
    return run_health(*arguments, interruption);
  };
}

}  // namespace tet
