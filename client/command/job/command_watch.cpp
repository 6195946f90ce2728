// `tetstream job watch`
#include <map>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"

namespace tet {
namespace {

constexpr const char* kWatchExamples = R"(
Without a JOB it tells of all from now on, until it is stopped. With some it begins with the first
change of theirs that is known, and ends when they are finished. Every change comes once and in
order, also when the connection breaks, or the server is started anew.

Examples:
  tetstream job watch --server farm:7447
  tetstream job watch jobs/019310c2a5d84f6b8e7a2c11 --server farm:7447
  tetstream job watch --after 4711 --json --server farm:7447
      goes on where another watch ended: after the revision that it told last
)";

struct WatchArguments {
  SessionArguments session;
  std::vector<std::string> names;
  std::optional<std::int64_t> after;
};

/// The jobs that are watched, each with the version that it has to get to, and finish in.
class WatchedJobs {
 public:
  void add(const v1::Job& job) { versions_[job.name()] = job.version(); }

  bool watches(const v1::JobEvent& event) const {
    return versions_.empty() || versions_.contains(event.name());
  }
  /// False when there is nothing left to wait for.
  bool take(const v1::JobEvent& event) {
    if (versions_.empty()) return true;
    const bool over = event.change() == v1::JOB_CHANGE_DELETED ||
                      (is_final(event.state()) && event.version() >= versions_[event.name()]);
    finished_[event.name()] = over;
    std::size_t finished = 0;
    for (const auto& [name, is_finished] : finished_) finished += is_finished ? 1 : 0;
    return finished < versions_.size();
  }
  /// For the server, when there is one.
  std::string only() const { return versions_.size() == 1 ? versions_.begin()->first : ""; }

 private:
  std::map<std::string, std::int64_t> versions_;
  std::map<std::string, bool> finished_;
};

absl::StatusOr<WatchedJobs> find_jobs(JobSession& session,
                                      const std::vector<std::string>& names,
                                      const Cancellation& cancellation) {
  WatchedJobs watched;
  if (names.empty()) return watched;
  const auto selected =
      select_jobs(session.jobs, {.names = names, .filter = {}, .journal = {}}, cancellation);
  if (!selected.ok()) return selected.status();
  for (const std::string& name : *selected) {
    const auto job = session.jobs.get(name, cancellation);
    if (!job.ok()) return job.status();
    watched.add(*job);
  }
  return watched;
}

absl::StatusOr<std::int64_t> first_revision(JobSession& session,
                                            const WatchArguments& arguments,
                                            const Cancellation& cancellation) {
  if (arguments.after) return *arguments.after;
  if (!arguments.names.empty()) return 0;
  v1::ListJobsRequest request;
  request.set_page_size(1);
  const auto page = session.jobs.list(request, cancellation);
  if (!page.ok()) return page.status();
  return page->revision();
}

absl::Status run_watch(const WatchArguments& arguments, const Cancellation& interruption) {
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  auto watched = find_jobs(**session, arguments.names, interruption);
  if (!watched.ok()) return watched.status();
  const auto after = first_revision(**session, arguments, interruption);
  if (!after.ok()) return after.status();
  return (*session)->jobs.watch(
      watched->only(), *after,
      [&](const v1::JobEvent& event) {
        if (!watched->watches(event)) return true;
        (*session)->print(as_json(event), event_line(event));
        return watched->take(event);
      },
      interruption);
}

}  // namespace

Command add_watch_command(CLI::App& app) {
  const auto arguments = std::make_shared<WatchArguments>();
  app.footer(kWatchExamples);
  app.add_option("JOB", arguments->names, "jobs/ID or the id alone; - reads them, one a line");
  app.add_option("--after", arguments->after,
                 "Begin after this revision; 0 takes all there are")
      ->type_name("REVISION")
      ->check(CLI::NonNegativeNumber);
  describe_session(app, arguments->session);
  return [arguments](const Cancellation& interruption) {
    return run_watch(*arguments, interruption);
  };
}

}  // namespace tet
