#include "client/command/job/job_text.h"

#include <map>
#include <set>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

#include "client/command/job/job_json.h"
#include "client/library/error_details.h"
#include "core/base/printable.h"

namespace tet {
namespace {

absl::Time time_of(const google::protobuf::Timestamp& time) {
  return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
}

std::string show(const google::protobuf::Timestamp& time) {
  return absl::FormatTime("%Y-%m-%d %H:%M:%S", time_of(time), absl::LocalTimeZone());
}

std::string show(const google::protobuf::Duration& duration) {
  return absl::FormatDuration(absl::Seconds(duration.seconds()) +
                              absl::Nanoseconds(duration.nanos()));
}

std::string show(const v1::JobProgress& progress) {
  if (progress.chunk_count() == 0) return progress.shard_count() > 1 ? "counting" : "";
  return absl::StrFormat("%d/%d chunks", progress.done_chunks(), progress.chunk_count());
}

std::string show_labels(const v1::Job& job) {
  const std::map<std::string, std::string> sorted(job.labels().begin(), job.labels().end());
  return for_terminal(absl::StrJoin(sorted, " ", absl::PairFormatter("=")));
}

/// In whole seconds, with a unit also where there is none of them.
std::string in_seconds(absl::Duration duration) {
  const absl::Duration whole = absl::Trunc(duration, absl::Seconds(1));
  return whole == absl::ZeroDuration() ? "0s" : absl::FormatDuration(whole);
}

std::string age_of(const v1::Job& job) {
  const absl::Duration age = absl::Now() - time_of(job.create_time());
  if (age >= absl::Hours(48)) return absl::StrCat(age / absl::Hours(24), "d");
  return in_seconds(age);
}

std::string show(const google::rpc::Status& error) {
  const absl::Status status = to_absl(error);
  const std::string reason = reason_of_failure(status);
  return for_terminal(
      absl::StrCat(reason.empty() ? absl::StatusCodeToString(status.code()) : reason, ": ",
                   error.message()));
}

std::string show_rate(const v1::JobProgress& progress) {
  std::string text = show(progress);
  absl::StrAppendFormat(&text, "%s%d of %d shards done, %d running", text.empty() ? "" : ", ",
                        progress.done_shards(), progress.shard_count(),
                        progress.running_shards());
  if (progress.dead_shards() > 0)
    absl::StrAppendFormat(&text, ", %d failed", progress.dead_shards());
  if (progress.chunks_per_second() > 0)
    absl::StrAppendFormat(&text, ", %.3g chunks/s", progress.chunks_per_second());
  if (progress.has_eta()) absl::StrAppend(&text, ", ", show(progress.eta()), " left");
  return text;
}

/// Lines of `key   value`, of what there is to say. Values are the server's words.
class Description {
 public:
  void add(const char* key, const std::string& value) {
    if (!value.empty()) absl::StrAppendFormat(&text_, "  %-12s %s\n", key, for_terminal(value));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void describe_request(const v1::Job& job, Description& description) {
  description.add("name", job.display_name());
  description.add("grid", job.mesh().name());
  description.add("mesh", job.mesh().ShortDebugString());
  description.add("labels", show_labels(job));
  if (job.priority() != 0) description.add("priority", absl::StrCat(job.priority()));
  if (job.has_ttl()) description.add("ttl", show(job.ttl()));
  if (job.has_timeout()) description.add("timeout", show(job.timeout()));
  if (job.has_max_attempts()) description.add("max attempts", absl::StrCat(job.max_attempts()));
}

void describe_state(const v1::Job& job, Description& description) {
  description.add("made", show(job.create_time()));
  if (job.has_start_time()) description.add("started", show(job.start_time()));
  if (job.has_finish_time()) description.add("finished", show(job.finish_time()));
  if (job.has_stop_time() && !job.has_finish_time())
    description.add("stops", show(job.stop_time()));
  if (job.has_queue_position())
    description.add("queue", absl::StrCat(job.queue_position(), " jobs before it"));
  if (job.progress().shard_count() > 0) description.add("progress", show_rate(job.progress()));
  if (job.cached()) description.add("cached", "the result was stored already");
  if (job.has_header()) {
    description.add("result",
                    absl::StrFormat("%d vertices, %d tets", job.header().vertex_count(),
                                    job.header().tet_count()));
  }
  if (job.replans() > 0)
    description.add("replanned", absl::StrCat(job.replans(),
                                              " times, by another algorithm version: what was "
                                              "done before was dropped"));
  if (job.given_back_shards() > 0)
    description.add("given back", absl::StrCat(job.given_back_shards(), " shards, the last: ",
                                               show(job.last_give_back())));
  if (job.has_error()) description.add("error", show(job.error()));
  if (job.determinism_alarms() > 0)
    description.add("ALARM", absl::StrCat(job.determinism_alarms(),
                                          " shards came with other bytes than were stored"));
}

}  // namespace

std::string table_header() {
  return absl::StrFormat("%-29s  %-9s  %-18s  %9s  %s", "job", "state", "progress", "age",
                         "name, labels");
}

std::string table_line(const v1::Job& job) {
  return absl::StrFormat("%-29s  %-9s  %-18s  %9s  %s  %s", for_terminal(job.name()),
                         name_of(job.state()), show(job.progress()), age_of(job),
                         for_terminal(job.display_name()), show_labels(job));
}

std::string workers_header() {
  return absl::StrFormat("%-29s  %-7s  %-11s  %9s  %7s  %s", "worker", "version", "state",
                         "last seen", "shards", "of your jobs");
}

std::string table_line(const v1::Worker& worker, const google::protobuf::Timestamp& now) {
  const absl::Duration unseen = time_of(now) - time_of(worker.seen_time());
  std::set<std::string> jobs;
  for (const v1::LeasedShard& shard : worker.shards()) jobs.insert(for_terminal(shard.job()));
  std::string line =
      absl::StrFormat("%-29s  %-7s  %-11s  %9s  %7d  %s", for_terminal(worker.name()),
                      for_terminal(worker.algorithm_version()), state_of(worker),
                      in_seconds(unseen), worker.leased_shards(), absl::StrJoin(jobs, " "));
  if (worker.has_trouble()) absl::StrAppend(&line, "\n  ", show(worker.trouble()));
  return std::string(absl::StripTrailingAsciiWhitespace(line));
}

std::string description_of(const v1::Job& job, const std::vector<v1::DeadShard>& dead_shards) {
  Description description;
  describe_request(job, description);
  describe_state(job, description);
  std::string text = absl::StrCat(for_terminal(job.name()), "  ", name_of(job.state()), "\n",
                                  description.text());
  for (const v1::DeadShard& shard : dead_shards) {
    absl::StrAppendFormat(&text, "  chunks %d to %d failed, attempts: %d (%s), %s\n",
                          shard.first_chunk(), shard.end_chunk(), shard.attempts(),
                          for_terminal(shard.worker()), show(shard.error()));
  }
  return text;
}

std::string outcome_line(const v1::Job& job) {
  const bool deleted = job.state() == v1::JOB_STATE_UNSPECIFIED;
  std::string line = absl::StrFormat("%s  %-9s  %s", for_terminal(job.name()),
                                     deleted ? "DELETED" : name_of(job.state()),
                                     for_terminal(job.display_name()));
  if (job.has_error()) absl::StrAppend(&line, ": ", show(job.error()));
  return line;
}

std::string event_line(const v1::JobEvent& event) {
  return absl::StrFormat(
      "%s  %d  %s  %-12s  %-9s  %s",
      absl::FormatTime("%H:%M:%S", time_of(event.time()), absl::LocalTimeZone()),
      event.revision(), for_terminal(event.name()), name_of(event.change()),
      name_of(event.state()), show(event.progress()));
}

}  // namespace tet
