#include "client/command/job/follow_jobs.h"

#include <map>
#include <utility>

#include "client/command/job/job_json.h"
#include "client/library/error_details.h"

namespace tet {
namespace {

double share_done(const v1::JobProgress& progress) {
  if (progress.chunk_count() <= 0) return 0;
  return static_cast<double>(progress.done_chunks()) /
         static_cast<double>(progress.chunk_count());
}

/// The jobs that are not finished, and how far each is.
class Following {
 public:
  Following(JobClient& client,
            const std::vector<std::string>& names,
            const FollowWatch& watch,
            const Cancellation& cancellation)
      : client_(client), watch_(watch), cancellation_(cancellation) {
    for (const std::string& name : names) pending_[name] = 0;
    total_ = pending_.size();
  }

  bool done() const { return pending_.empty(); }

  absl::Status look() {
    std::vector<std::string> names;
    for (const auto& [name, share] : pending_) names.push_back(name);
    for (const std::string& name : names) {
      if (absl::Status status = look_at(name); !status.ok()) return status;
    }
    all_known_ = true;
    return absl::OkStatus();
  }

  absl::Status watch_from(std::int64_t revision) {
    absl::Status looked;
    const auto see = [&](const v1::JobEvent& event) {
      looked = take(event);
      return looked.ok() && !done();
    };
    const std::string only = pending_.size() == 1 ? pending_.begin()->first : "";
    const absl::Status watched = client_.watch(only, revision, see, cancellation_);
    return looked.ok() ? watched : looked;
  }

 private:
  absl::Status look_at(const std::string& name) {
    const auto job = client_.get(name, cancellation_);
    // Whoever has found it before may delete it before we get it.
    if (all_known_ && absl::IsNotFound(job.status())) return finish_deleted(name);
    if (!job.ok()) return job.status();
    if (is_final(job->state())) return finish(*job);
    return advance(name, share_done(job->progress()));
  }

  absl::Status take(const v1::JobEvent& event) {
    if (!pending_.contains(event.name())) return absl::OkStatus();
    if (event.change() == v1::JOB_CHANGE_DELETED) return finish_deleted(event.name());
    if (is_final(event.state())) return look_at(event.name());
    return advance(event.name(), share_done(event.progress()));
  }

  absl::Status finish_deleted(const std::string& name) {
    v1::Job deleted;
    deleted.set_name(name);
    return finish(deleted);
  }

  absl::Status finish(const v1::Job& job) {
    pending_.erase(job.name());
    watch_.finished(job);
    return show();
  }

  absl::Status advance(const std::string& name, double share) {
    pending_[name] = share;
    return show();
  }

  absl::Status show() {
    auto jobs = static_cast<double>(total_ - pending_.size());
    for (const auto& [name, share] : pending_) jobs += share;
    watch_.progress(jobs);
    return absl::OkStatus();
  }

  JobClient& client_;
  const FollowWatch& watch_;
  const Cancellation& cancellation_;
  std::map<std::string, double> pending_;  ///< with the share that is done
  std::size_t total_ = 0;
  bool all_known_ = false;  ///< the server has had every job
};

}  // namespace

absl::Status follow_jobs(JobClient& client,
                         const std::vector<std::string>& names,
                         const FollowWatch& watch,
                         const Cancellation& cancellation) {
  Following following(client, names, watch, cancellation);
  while (!following.done()) {
    // Before the look, so that nothing is missed of what it sees.
    const auto revision = client.revision(cancellation);
    if (!revision.ok()) return revision.status();
    if (absl::Status status = following.look(); !status.ok()) return status;
    if (following.done()) break;
    const absl::Status status = following.watch_from(*revision);
    // Some changes are forgotten: look again.
    if (!status.ok() && reason_of_failure(status) != "REVISION_COMPACTED") return status;
  }
  return absl::OkStatus();
}

Patience::Patience(const Cancellation& interruption, std::chrono::nanoseconds time)
    : cancellation_(Cancellation::Clock::now() +
                    std::chrono::duration_cast<Cancellation::Clock::duration>(time)),
      on_interruption_(interruption, [this] { cancellation_.cancel(); }) {}

}  // namespace tet
