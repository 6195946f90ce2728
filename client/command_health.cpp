// `tetstream health`: is a server serving?
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "client/command.h"
#include "client/mesh_client.h"

namespace tet {
namespace {

constexpr const char* kExamples = R"(
Exits with 0 when the server says that it is serving, and with 3 otherwise.

Example:
  tetstream health --server localhost:7447
)";

absl::Status run_health(const std::string& server, const Cancellation& interruption) {
  const auto client = MeshClient::connect(server, {.attempts = 1});
  const absl::Status status = client->check_health("readiness", interruption);
  // Whatever the answer was, it is the server that is not well.
  if (!status.ok()) return absl::UnavailableError(status.message());
  std::printf("%s: serving\n", server.c_str());
  return absl::OkStatus();
}

}  // namespace

Command add_health_command(CLI::App& app) {
  const auto server = std::make_shared<std::string>();
  app.footer(kExamples);
  app.add_option("--server", *server, "HOST:PORT of a tetstreamd")->required();
  return
      [server](const Cancellation& interruption) { return run_health(*server, interruption); };
}

}  // namespace tet
