// `tetstream job watch`
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"
#include "client/library/error_details.h"

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
  /// `is_over`: nothing comes of it any more.
  void add(const v1::Job& job, bool is_over) {
    versions_[job.name()] = job.version();
    finished_[job.name()] = is_over;
  }

  bool watches(const v1::JobEvent& event) const {
    return versions_.empty() || versions_.contains(event.name());
  }
  /// False when there is nothing left to wait for.
  bool take(const v1::JobEvent& event) {
    if (versions_.empty()) return true;
    const bool over = event.change() == v1::JOB_CHANGE_DELETED ||
                      (is_final(event.state()) && event.version() >= versions_[event.name()]);
    finished_[event.name()] = over;
    return !are_over();
  }
  /// Whether there is nothing left to wait for from the beginning.
  bool are_over() const {
    return !finished_.empty() &&
           std::ranges::all_of(finished_, [](const auto& job) { return job.second; });
  }
  /// For the server, when there is one.
  std::string only() const { return versions_.size() == 1 ? versions_.begin()->first : ""; }
  /// Those that are waited for: one that is over may be gone.
  std::vector<std::string> pending() const {
    std::vector<std::string> names;
    for (const auto& [name, is_over] : finished_) {
      if (!is_over) names.push_back(name);
    }
    return names;
  }

 private:
  std::map<std::string, std::int64_t> versions_;
  std::map<std::string, bool> finished_;
};

/// Whether the last change of a job that is finished came by a revision: nothing comes after
/// it.
absl::StatusOr<bool> was_over_by(std::int64_t revision,
                                 JobClient& jobs,
                                 const v1::Job& job,
                                 const Cancellation& cancellation) {
  if (!is_final(job.state()) || revision == 0) return false;
  std::int64_t last = 0;
  const auto see = [&](const v1::JobEvent& event) {
    last = event.revision();
    return event.version() < job.version();
  };
  const absl::Status told = jobs.watch(job.name(), 0, see, cancellation);
  if (!told.ok()) return told;
  return last <= revision;
}

absl::StatusOr<WatchedJobs> find_jobs(JobSession& session,
                                      const WatchArguments& arguments,
                                      const Cancellation& cancellation) {
  WatchedJobs watched;
  if (arguments.names.empty()) return watched;
  const auto selected = select_jobs(
      session.jobs, {.names = arguments.names, .filter = {}, .journal = {}}, cancellation);
  if (!selected.ok()) return selected.status();
  for (const std::string& name : *selected) {
    const auto job = session.jobs.get(name, cancellation);
    if (!job.ok()) return job.status();
    const auto over =
        was_over_by(arguments.after.value_or(0), session.jobs, *job, cancellation);
    if (!over.ok()) return over.status();
    watched.add(*job, *over);
  }
  return watched;
}

absl::StatusOr<std::int64_t> first_revision(JobSession& session,
                                            const WatchArguments& arguments,
                                            const Cancellation& cancellation) {
  if (arguments.after) return *arguments.after;
  if (!arguments.names.empty()) return 0;
  return session.jobs.revision(cancellation);
}

/// Changes up to a revision, in their order.
struct Changes {
  std::int64_t revision = 0;
  std::vector<v1::JobEvent> events;
};

/// Adds a job's own changes after a revision, up to that of `changes`.
absl::Status add_changes(JobClient& jobs,
                         const std::string& name,
                         std::int64_t after,
                         Changes& changes,
                         const Cancellation& cancellation) {
  const auto job = jobs.get(name, cancellation);
  if (!job.ok() && !absl::IsNotFound(job.status())) return job.status();
  // A job that was deleted has a last change, with which its watch ends by itself. Of any other
  // all changes are read, since whether there is one after a revision is not known before.
  const std::int64_t last_version = job.ok() ? job->version() : INT64_MAX;
  const auto see = [&](const v1::JobEvent& event) {
    const bool is_missed = event.revision() > after && event.revision() <= changes.revision;
    if (is_missed) changes.events.push_back(event);
    return event.version() < last_version;
  };
  return jobs.watch(name, 0, see, cancellation);
}

/// What jobs went through after a revision, up to now: job by job, since each has its own
/// changes for as long as it is there, whatever was purged of others.
absl::StatusOr<Changes> changes_of(JobClient& jobs,
                                   const std::vector<std::string>& names,
                                   std::int64_t after,
                                   const Cancellation& cancellation) {
  const auto revision = jobs.revision(cancellation);
  if (!revision.ok()) return revision.status();
  Changes changes{*revision, {}};
  for (const std::string& name : names) {
    const absl::Status added = add_changes(jobs, name, after, changes, cancellation);
    if (!added.ok()) return added;
  }
  std::ranges::sort(changes.events, {}, &v1::JobEvent::revision);
  return changes;
}

/// Several jobs are watched as all are, and only where changes of some were purged job by job.
absl::Status watch_from(std::int64_t after,
                        JobSession& session,
                        WatchedJobs& watched,
                        const Cancellation& cancellation) {
  const auto see = [&](const v1::JobEvent& event) {
    after = event.revision();
    if (!watched.watches(event)) return true;
    // What nobody reads is at its end, which main tells of.
    return session.print(as_json(event), event_line(event)) && watched.take(event);
  };
  for (;;) {
    const absl::Status status = session.jobs.watch(watched.only(), after, see, cancellation);
    const std::vector<std::string> names = watched.pending();
    if (names.empty() || reason_of_failure(status) != "REVISION_COMPACTED") return status;
    const auto missed = changes_of(session.jobs, names, after, cancellation);
    if (!missed.ok()) return missed.status();
    for (const v1::JobEvent& event : missed->events) {
      if (!see(event)) return absl::OkStatus();
    }
    after = missed->revision;
  }
}

absl::Status run_watch(const WatchArguments& arguments, const Cancellation& interruption) {
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  auto watched = find_jobs(**session, arguments, interruption);
  if (!watched.ok()) return watched.status();
  if (watched->are_over()) return absl::OkStatus();
  const auto after = first_revision(**session, arguments, interruption);
  if (!after.ok()) return after.status();
  return watch_from(*after, **session, *watched, interruption);
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
