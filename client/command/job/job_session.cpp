#include "client/command/job/job_session.h"

#include <cstdio>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "client/command/job/job_json.h"
#include "client/command/process/exit_code.h"
#include "client/library/client_call.h"
#include "client/library/connection.h"

namespace tet {

void describe_session(CLI::App& app, SessionArguments& arguments) {
  app.add_flag("--json", arguments.json, "One JSON object a line, for programs");
  describe_server(app, arguments.server)->required();
}

absl::StatusOr<std::unique_ptr<JobSession>> JobSession::open(
    const SessionArguments& arguments) {
  const auto channel = understand_server(arguments.server);
  if (!channel.ok()) return channel.status();
  const auto connection = Connection::open(arguments.server.address, *channel);
  if (!connection.ok()) return connection.status();
  return std::unique_ptr<JobSession>(new JobSession(*connection, arguments.json));
}

bool JobSession::print(const nlohmann::ordered_json& object, const std::string& text) {
  json ? bar.say(line_of(object), stdout) : bar.say_lines(text, stdout);
  return std::ferror(stdout) == 0;
}

void JobSession::failed(const std::string& name, const absl::Status& status) {
  if (failures_++ == 0) {
    first_failure_ = absl::Status(status.code(), absl::StrCat(name, ": ", status.message()));
    status.ForEachPayload(
        [&](auto url, const auto& bytes) { first_failure_.SetPayload(url, bytes); });
  }
  if (json) {
    print({{"name", name}, {"error", as_json(status)}}, "");
  } else {
    bar.say(absl::StrCat(name, ": ", status.message()));
  }
}

absl::Status JobSession::outcome(std::size_t total) const {
  if (failures_ == 0 || total == 1) return first_failure_;
  absl::Status status(first_failure_.code(),
                      absl::StrFormat("%d of %d failed; the first: %s", failures_, total,
                                      first_failure_.message()));
  first_failure_.ForEachPayload(
      [&](auto url, const auto& bytes) { status.SetPayload(url, bytes); });
  return status;
}

namespace {

/// Whether other jobs would fail in the same way. Damage is one job's: a chunk of its result,
/// or what was sent of it.
bool is_of_the_server(const absl::Status& status) {
  return exit_code_of(status.code()) == ExitCode::kServer && !absl::IsDataLoss(status);
}

}  // namespace

absl::Status for_each_of(JobSession& session,
                         const std::vector<std::string>& names,
                         const std::function<absl::Status(const std::string&)>& act,
                         const Cancellation& cancellation) {
  for (const std::string& name : names) {
    const absl::Status status = act(name);
    if (absl::Status cancelled = check(cancellation); !cancelled.ok()) return cancelled;
    if (is_of_the_server(status)) return status;
    if (status.ok()) continue;
    if (names.size() == 1 && !session.json) return status;  // which is told once
    session.failed(name, status);
  }
  return session.outcome(names.size());
}

absl::Status for_each_selected(JobSession& session,
                               const SelectionArguments& selection,
                               const std::function<absl::Status(const std::string&)>& act,
                               const Cancellation& cancellation) {
  const auto names = select_jobs(session.jobs, selection, cancellation);
  if (!names.ok()) return names.status();
  return for_each_of(session, *names, act, cancellation);
}

}  // namespace tet
