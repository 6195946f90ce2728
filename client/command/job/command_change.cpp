// `tetstream job cancel`, `retry` and `delete`: one call for each job.
#include <functional>
#include <memory>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"
#include "core/base/printable.h"

namespace tet {
namespace {

constexpr const char* kCancelExamples = R"(
What is done is kept, for `retry`; a job that is finished stays as it is.

Examples:
  tetstream job cancel jobs/019310c2a5d84f6b8e7a2c11 --server farm:7447
  tetstream job cancel --label night=monday --state queued --server farm:7447
)";

constexpr const char* kRetryExamples = R"(
What is done stays done; the rest is tried again with all its attempts, its time to live and its
timeout.

Examples:
  tetstream job retry jobs/019310c2a5d84f6b8e7a2c11 --server farm:7447
  tetstream job retry --state failed --since 12h --server farm:7447
)";

constexpr const char* kDeleteExamples = R"(
A job that is queued or runs has to be cancelled first.

Examples:
  tetstream job delete jobs/019310c2a5d84f6b8e7a2c11 --server farm:7447
  tetstream job delete --state succeeded --until 720h --server farm:7447
)";

struct ChangeArguments {
  SessionArguments session;
  SelectionArguments selection;
};

/// Changes one job and tells what became of it.
using Change = absl::Status (*)(JobSession&, const std::string&, const Cancellation&);

absl::Status tell(JobSession& session, const absl::StatusOr<v1::Job>& job) {
  if (!job.ok()) return job.status();
  session.print(as_json(*job), outcome_line(*job));
  return absl::OkStatus();
}

absl::Status cancel_job(JobSession& session,
                        const std::string& name,
                        const Cancellation& cancellation) {
  return tell(session, session.jobs.cancel(name, cancellation));
}

absl::Status retry_job(JobSession& session,
                       const std::string& name,
                       const Cancellation& cancellation) {
  return tell(session, session.jobs.retry(name, cancellation));
}

absl::Status delete_job(JobSession& session,
                        const std::string& name,
                        const Cancellation& cancellation) {
  const absl::Status status = session.jobs.remove(name, cancellation);
  if (!status.ok()) return status;
  session.print({{"name", name}, {"deleted", true}},
                for_terminal(absl::StrCat(name, "  deleted")));
  return absl::OkStatus();
}

Command add_change(CLI::App& app, const char* examples, Change change) {
  const auto arguments = std::make_shared<ChangeArguments>();
  app.footer(examples);
  describe_selection(app, arguments->selection);
  describe_session(app, arguments->session);
  return [arguments, change](const Cancellation& interruption) -> absl::Status {
    const auto session = JobSession::open(arguments->session);
    if (!session.ok()) return session.status();
    return for_each_selected(
        **session, arguments->selection,
        [&](const std::string& name) { return change(**session, name, interruption); },
        interruption);
  };
}

}  // namespace

Command add_cancel_command(CLI::App& app) {
  return add_change(app, kCancelExamples, cancel_job);
}

Command add_retry_command(CLI::App& app) { return add_change(app, kRetryExamples, retry_job); }

Command add_delete_command(CLI::App& app) {
  return add_change(app, kDeleteExamples, delete_job);
}

}  // namespace tet
