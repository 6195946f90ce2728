// What all commands on jobs share: the server, the selection, the output, and failures of some.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <nlohmann/json.hpp>

#include "client/command/arguments/server_options.h"
#include "client/command/job/job_selection.h"
#include "client/command/process/progress_bar.h"
#include "client/library/job_client.h"
#include "client/library/mesh_client.h"

namespace tet {

/// Options of every command on jobs.
struct SessionArguments {
  ServerArguments server;
  bool json = false;
};
void describe_session(CLI::App& app, SessionArguments& arguments);

/// A server, spoken to over one connection, and where the answers go. Thread-safe.
class JobSession {
 public:
  /// Errors: those of understand_server and Connection::open.
  static absl::StatusOr<std::unique_ptr<JobSession>> open(const SessionArguments& arguments);

  MeshClient meshes;
  JobClient jobs;
  ProgressBar bar;
  const bool json;

  /// A line of results: `object` for programs, `text` for people. False where some of what was
  /// printed did not arrive: then nobody reads what follows.
  bool print(const nlohmann::ordered_json& object, const std::string& text);

  /// One of many failed, and the others go on: told on stderr, or to programs as an object.
  void failed(const std::string& name, const absl::Status& status);

  /// kOk unless some failed: then how many of `total`, with the first one's code and details.
  absl::Status outcome(std::size_t total) const;

 private:
  JobSession(const std::shared_ptr<Connection>& connection, bool as_json)
      : meshes(connection), jobs(connection), json(as_json) {}

  std::size_t failures_ = 0;
  absl::Status first_failure_;
};

/// Calls `act` with each job's name until an error that all others would meet too. Errors of
/// other kinds are told, and the session's outcome returned.
absl::Status for_each_of(JobSession& session,
                         const std::vector<std::string>& names,
                         const std::function<absl::Status(const std::string&)>& act,
                         const Cancellation& cancellation);

/// Calls `act` with the name of each job that is selected, as for_each_of does.
absl::Status for_each_selected(JobSession& session,
                               const SelectionArguments& selection,
                               const std::function<absl::Status(const std::string&)>& act,
                               const Cancellation& cancellation);

}  // namespace tet
