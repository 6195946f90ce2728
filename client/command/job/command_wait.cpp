// `tetstream job wait`
#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/time/time.h>

#include "client/command/job/follow_jobs.h"
#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"

namespace tet {
namespace {

constexpr const char* kWaitExamples = R"(
A line for each job when it is finished, and in the end how many ended how. Exits with 0 when all
succeeded, with 1 when some did not or there is none, and with 3 when --patience is over before they
are finished.

Examples:
  tetstream job wait jobs/019310c2a5d84f6b8e7a2c11 --server farm:7447
  tetstream job wait --label night=monday --server farm:7447
  tetstream job submit *.vdb --server farm:7447 | tetstream job wait - --server farm:7447
)";

struct WaitArguments {
  SessionArguments session;
  SelectionArguments selection;
  std::string patience;
};

/// How many ended how.
class Summary {
 public:
  void add(const v1::Job& job) {
    const bool deleted = job.state() == v1::JOB_STATE_UNSPECIFIED;
    ++counts_[deleted ? "deleted" : absl::AsciiStrToLower(name_of(job.state()))];
    if (job.state() != v1::JOB_STATE_SUCCEEDED) ++unsuccessful_;
    ++total_;
  }
  /// "20 jobs: 18 succeeded, 2 failed"
  std::string text() const {
    std::string text = absl::StrCat(total_, total_ == 1 ? " job" : " jobs");
    const char* separator = ": ";
    for (const auto& [state, count] : counts_) {
      absl::StrAppend(&text, separator, count, " ", state);
      separator = ", ";
    }
    return text;
  }
  absl::Status status() const {
    return unsuccessful_ == 0 ? absl::OkStatus() : absl::FailedPreconditionError(text());
  }

 private:
  std::map<std::string, std::size_t> counts_;
  std::size_t total_ = 0, unsuccessful_ = 0;
};

absl::Status wait_for(JobSession& session,
                      const std::vector<std::string>& names,
                      const Cancellation& cancellation) {
  Summary summary;
  const auto total = static_cast<double>(names.size());
  session.bar.begin("waiting", "jobs");
  const FollowWatch watch{.finished =
                              [&](const v1::Job& job) {
                                summary.add(job);
                                session.print(as_json(job), outcome_line(job));
                              },
                          .progress = [&](double jobs) { session.bar.update(jobs, total); }};
  const absl::Status followed = follow_jobs(session.jobs, names, watch, cancellation);
  if (!followed.ok()) return followed;
  if (!session.json && summary.status().ok()) session.bar.say(summary.text(), stdout);
  return summary.status();
}

absl::StatusOr<absl::Duration> parse_patience(const std::string& text) {
  constexpr absl::Duration kForEver = absl::Hours(24 * 365 * 100);  // clocks can say no more
  absl::Duration time = kForEver;
  if (text.empty() || (absl::ParseDuration(text, &time) && time > absl::ZeroDuration()))
    return std::min(time, kForEver);
  return absl::InvalidArgumentError(
      absl::StrCat("--patience ", text, " is not a time such as 90s, 30m or 12h"));
}

absl::Status run_wait(const WaitArguments& arguments, const Cancellation& interruption) {
  const auto time = parse_patience(arguments.patience);
  if (!time.ok()) return time.status();
  const Patience patience(interruption, absl::ToChronoNanoseconds(*time));
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  const auto names = select_jobs((*session)->jobs, arguments.selection, interruption);
  if (!names.ok()) return names.status();
  if (auto status = check_any(*names, arguments.selection); !status.ok()) return status;
  return wait_for(**session, *names, patience.cancellation());
}

}  // namespace

Command add_wait_command(CLI::App& app) {
  const auto arguments = std::make_shared<WaitArguments>();
  app.footer(kWaitExamples);
  describe_selection(app, arguments->selection);
  app.add_option("--patience", arguments->patience, "The longest to wait [for ever]")
      ->type_name("TIME");
  describe_session(app, arguments->session);
  return [arguments](const Cancellation& interruption) {
    return run_wait(*arguments, interruption);
  };
}

}  // namespace tet
