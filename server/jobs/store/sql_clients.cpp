// The store for clients: jobs come, are looked up and listed, and go.
#include <algorithm>
#include <limits>
#include <random>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>

#include "proto/convert/status.h"
#include "server/jobs/store/job_rows.h"
#include "server/jobs/store/new_job.h"
#include "server/jobs/store/page_token.h"
#include "server/jobs/store/queue_rows.h"
#include "server/jobs/store/sql_job_store.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

/// As many rows of a list are read at a time. Most pages have no more jobs; and the largest
/// rows, of more than 128 KiB each, take 16 MiB then.
constexpr std::int64_t kListedAtOnce = 128;

/// The time, so that ids sort by age, and 40 random bits.
std::string make_id(std::int64_t now_us) {
  thread_local std::mt19937_64 random{std::random_device{}()};
  return absl::StrFormat("%014x%010x", now_us, random() & ((std::uint64_t{1} << 40) - 1));
}

JobRow new_row(const NewJob& wanted, std::int64_t now_us) {
  JobRow row;
  row.job.id = make_id(now_us);
  row.job.space = wanted.space;
  row.job.display_name = wanted.display_name;
  row.job.spec = wanted.spec;
  row.job.labels = wanted.labels;
  row.job.priority = wanted.priority;
  row.job.max_attempts = wanted.max_attempts;
  row.job.version = 1;
  row.job.create_time = from_us(now_us);
  row.job.shard_count = 1;
  row.ttl = wanted.ttl;
  row.timeout = wanted.timeout;
  row.expire_us = after_us(now_us, wanted.ttl);
  row.job.stop_time = from_us(row.expire_us);
  return row;
}

/// Takes the request id for `job`, unless it is taken.
bool claim_request(SqlTransaction& t, const NewJob& wanted, const std::string& job) {
  if (wanted.request_id.empty()) return true;
  return t.run(
              "INSERT INTO requests (space, request_id, job_id, fingerprint) VALUES ($1, $2, "
              "$3, $4) ON CONFLICT DO NOTHING",
              {wanted.space, wanted.request_id, job, fingerprint(wanted)})
             .changed == 1;
}

/// The job that the same request made. Errors: kAlreadyExists.
absl::StatusOr<Job> job_of_request(SqlTransaction& t, const NewJob& wanted) {
  const auto found =
      t.run("SELECT job_id, fingerprint FROM requests WHERE space = $1 AND request_id = $2",
            {wanted.space, wanted.request_id});
  if (found.rows.empty()) return store_unavailable("the job was deleted meanwhile");
  const std::string& id = found.rows[0].text(0);
  if (found.rows[0].text(1) != fingerprint(wanted)) {
    return with_reason(
        absl::AlreadyExistsError(
            absl::StrCat("request_id ", wanted.request_id, " was used for another job, ", id)),
        "REQUEST_ID_REUSED");
  }
  const auto job =
      t.run(absl::StrCat(select_jobs({.bytes = true, .leases = true}), " WHERE id = $1"), {id});
  if (job.rows.empty()) return job_not_found(id);
  return job_row(job.rows[0]).job;
}

/// " WHERE ..." of a list, and its values.
struct Where {
  std::string sql;
  std::vector<SqlValue> values;

  /// `condition` has one parameter, written as $.
  void add(const std::string& condition, SqlValue value) {
    values.push_back(std::move(value));
    const std::vector<std::string> parts = absl::StrSplit(condition, '$');
    absl::StrAppend(&sql, sql.empty() ? " WHERE " : " AND ",
                    absl::StrJoin(parts, absl::StrCat("$", values.size())));
  }
};

void add_states(Where& where, const std::set<JobState>& states) {
  if (states.empty()) return;
  const auto number = [](std::string* out, JobState s) { absl::StrAppend(out, number_of(s)); };
  absl::StrAppend(&where.sql, where.sql.empty() ? " WHERE " : " AND ", "state IN (",
                  absl::StrJoin(states, ", ", number), ")");
}

Where where_of(const JobFilter& filter) {
  Where where;
  add_states(where, filter.states);
  if (!filter.space.empty()) where.add("space = $", filter.space);
  for (const auto& [key, value] : filter.labels) {
    where.add("replace(labels, $, '') <> labels", absl::StrCat("\n", key, "=", value, "\n"));
  }
  if (!filter.name_prefix.empty()) {
    where.add("substr(display_name, 1, length($)) = $", Blob{filter.name_prefix});
  }
  if (filter.created_from != absl::InfinitePast()) {
    where.add("create_us >= $", to_us(filter.created_from));
  }
  if (filter.created_before != absl::InfiniteFuture()) {
    where.add("create_us < $", to_us(filter.created_before));
  }
  return where;
}

/// What a list tells of a job, but for numbers and times, of which there are a few hundred
/// bytes.
std::size_t listed_bytes(const Job& job) {
  std::size_t bytes = job.spec.size() + job.display_name.size() +
                      encode_status(job.error).size() + encode_status(job.trouble).size();
  for (const auto& [key, value] : job.labels) bytes += key.size() + value.size();
  return bytes;
}

absl::Status check(const ListJobs& query) {
  if (query.page_size < 1 || query.page_size > 1000) {
    return invalid_field(absl::StrCat("page_size ", query.page_size, " is not from 1 to 1000"));
  }
  return check_labels(query.filter.labels);
}

}  // namespace

absl::StatusOr<CreatedJob> SqlJobStore::create(const NewJob& wanted) {
  if (auto status = check(wanted); !status.ok()) return status;
  CreatedJob created;
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    const JobRow row = new_row(wanted, t.now_us());
    created = {row.job, false};
    if (!claim_request(t, wanted, row.job.id)) {
      auto job = job_of_request(t, wanted);
      if (job.ok()) created = {std::move(*job), true};
      return job.status();
    }
    if (auto full = check_room(t, wanted.space); !full.ok()) return full;
    insert_job(t, row, wanted.input);
    add_to_queue(t, row, Phase::kPlan, 0, {{0, 0}});
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return created;
}

absl::Status SqlJobStore::check_room(SqlTransaction& t, const std::string& space) {
  constexpr std::int64_t kCounts = 100;  // on the way to the limit
  if (room_.take(space)) return absl::OkStatus();
  const std::int64_t limit = options_.max_unfinished;
  const std::int64_t count =
      t.integer("SELECT count(*) FROM jobs WHERE space = $1 AND state <= 2", {space});
  if (count >= limit) {
    return over_space_quota(space, "jobs that are not finished",
                            static_cast<std::uint64_t>(count) + 1,
                            static_cast<std::uint64_t>(limit));
  }
  room_.set(space, std::min(limit - count - 1, limit / kCounts));
  return absl::OkStatus();
}

absl::StatusOr<Job> SqlJobStore::get(const std::string& id) {
  Job job;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    const auto result = t.run(
        absl::StrCat(select_jobs({.bytes = true, .leases = true}), " WHERE id = $1"), {id});
    if (result.rows.empty()) return job_not_found(id);
    job = job_row(result.rows[0]).job;
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  job.read_time = now();
  return job;
}

/// Up to `most` jobs, the newest first, that are older than `after`, unless that is empty.
absl::StatusOr<std::vector<Job>> SqlJobStore::list_some(const JobFilter& filter,
                                                        const std::string& after,
                                                        std::int64_t most) {
  Where where = where_of(filter);
  if (!after.empty()) where.add("id < $", after);
  where.values.emplace_back(most);
  const std::string sql = absl::StrCat(select_jobs({.bytes = true, .leases = true}), where.sql,
                                       " ORDER BY id DESC LIMIT $", where.values.size());
  std::vector<Job> jobs;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    jobs.clear();
    for (const SqlRow& row : t.run(sql, where.values).rows) {
      jobs.push_back(job_row(row).job);
      jobs.back().read_time = now();
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return jobs;
}

absl::StatusOr<JobPage> SqlJobStore::list(const ListJobs& query) {
  if (auto status = check(query); !status.ok()) return status;
  auto last = job_after_token(query.page_token, query.filter);
  if (!last.ok()) return last.status();
  JobPage page;
  std::size_t bytes = 0;
  while (true) {
    const std::int64_t room = query.page_size + 1 - std::ssize(page.jobs);
    const std::int64_t most = std::min(room, kListedAtOnce);
    auto some = list_some(query.filter, *last, most);
    if (!some.ok()) return some.status();
    for (Job& job : *some) {
      if (std::ssize(page.jobs) == query.page_size || bytes >= kPageBytes) {
        page.next_page_token = make_page_token(page.jobs.back().id, query.filter);
        return page;
      }
      bytes += listed_bytes(job);
      page.jobs.push_back(std::move(job));
    }
    if (std::ssize(*some) < most) return page;
    *last = page.jobs.back().id;
  }
}

absl::StatusOr<std::int64_t> SqlJobStore::queue_position(const std::string& id,
                                                         std::int64_t most) {
  std::int64_t position = 0;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    position = 0;
    const auto job = t.run("SELECT rank, state FROM jobs WHERE id = $1", {id});
    if (job.rows.empty()) return job_not_found(id);
    if (job.rows[0].integer(1) != number_of(JobState::kQueued)) return absl::OkStatus();
    position = t.integer(
        "SELECT count(*) FROM (SELECT id FROM jobs WHERE state = 1 AND (rank, id) < ($1, $2) "
        "LIMIT $3) AS earlier",
        {job.rows[0].integer(0), id, most});
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return position;
}

absl::Status SqlJobStore::remove(const std::string& id) {
  return transact(
      *database_,
      [&](SqlTransaction& t) {
        auto row = lock_job(t, id);
        if (!row) return job_not_found(id);
        if (!is_finished(row->job.state)) {
          return with_reason(
              absl::FailedPreconditionError(absl::StrCat(
                  "job ", id, " is ", name_of(row->job.state), ": cancel it first")),
              "JOB_ACTIVE");
        }
        save_job(t, *row, JobChange::kDeleted);
        t.run("DELETE FROM shards WHERE job_id = $1", {id});
        t.run("DELETE FROM requests WHERE job_id = $1", {id});
        t.run("DELETE FROM jobs WHERE id = $1", {id});
        return absl::OkStatus();
      },
      Purpose::kRoom);
}

}  // namespace tet
