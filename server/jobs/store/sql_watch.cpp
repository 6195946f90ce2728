// The store for readers: events in the order of their revisions, and what the shards left.
#include <algorithm>
#include <chrono>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/jobs/store/new_job.h"
#include "server/jobs/store/queue_rows.h"
#include "server/jobs/store/sql_job_store.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

constexpr std::int64_t kDigestBytes = 32;
constexpr std::int64_t kNumberedAtOnce = 1000;

/// Gives committed events that have none their revisions; says how many.
///
/// Transactions that add events run side by side and commit in any order, so that a number
/// drawn by each of them would appear out of order, and a reader would miss those that come
/// late. Numbering what is committed, one reader at a time, has no such gaps, and costs the
/// writers nothing. A job's events keep their order: each was committed before the next could
/// be added.
absl::Status number_events(SqlDatabase& database, std::int64_t& numbered) {
  return transact(database, [&](SqlTransaction& t) {
    const std::int64_t last = t.integer(absl::StrCat(
        "SELECT value FROM counters WHERE name = 'revision'", t.dialect().for_update()));
    numbered =
        t.run(
             "UPDATE events SET revision = new.revision FROM (SELECT id AS new_id, $1 + "
             "row_number() OVER (ORDER BY id) AS revision FROM events WHERE revision = 0 "
             "ORDER BY id LIMIT $2) AS new WHERE events.id = new.new_id AND "
             "events.revision = 0",
             {last, kNumberedAtOnce})
            .changed;
    t.run("UPDATE counters SET value = $1 WHERE name = 'revision'", {last + numbered});
    return absl::OkStatus();
  });
}

std::int64_t counter(SqlTransaction& t, const std::string& name) {
  return t.integer("SELECT value FROM counters WHERE name = $1", {name});
}

absl::Status check(const WatchJobs& query) {
  if (query.limit >= 1 && query.limit <= 10'000) return absl::OkStatus();
  return invalid_field(absl::StrCat("limit ", query.limit, " is not from 1 to 10000"));
}

absl::Status out_of_range(const std::string& message, std::string_view reason) {
  return with_reason(absl::OutOfRangeError(message), reason);
}

/// Whether events after this revision are all there, and none of the future is meant. A job's
/// own events are there as long as it is.
absl::Status check_revision(SqlTransaction& t, const WatchJobs& query, std::int64_t last) {
  if (query.after_revision < 0 || query.after_revision > last) {
    return out_of_range(
        absl::StrCat("revision ", query.after_revision, " is not from 0 to ", last),
        "REVISION_UNKNOWN");
  }
  const std::int64_t compacted = query.job.empty() ? counter(t, "compacted") : 0;
  if (query.after_revision >= compacted) return absl::OkStatus();
  return out_of_range(absl::StrCat("events up to revision ", compacted,
                                   " were purged; read the jobs, then watch from there"),
                      "REVISION_COMPACTED");
}

JobEvent event_of(const SqlRow& row) {
  JobEvent event;
  event.revision = row.integer(0);
  event.job = row.text(1);
  event.space = row.text(2);
  event.version = row.integer(3);
  event.change = change_from(row.integer(4));
  event.state = state_from(row.integer(5));
  event.chunk_count = row.integer(6);
  event.done_chunks = row.integer(7);
  event.shard_count = row.integer(8);
  event.done_shards = row.integer(9);
  event.dead_shards = row.integer(10);
  event.time = from_us(row.integer(11));
  return event;
}

SqlResult select_events(SqlTransaction& t, const WatchJobs& query, std::int64_t last) {
  std::string sql =
      "SELECT revision, job_id, space, version, change, state, chunk_count, done_chunks, "
      "shard_count, done_shards, dead_shards, time_us FROM events WHERE revision > $1 AND "
      "revision <= $2";
  std::vector<SqlValue> values = {query.after_revision, last, query.limit};
  const auto only = [&](const char* column, const std::string& value) {
    if (value.empty()) return;
    values.emplace_back(value);
    absl::StrAppend(&sql, " AND ", column, " = $", values.size());
  };
  only("job_id", query.job);
  only("space", query.space);
  absl::StrAppend(&sql, " ORDER BY revision LIMIT $3");
  return t.run(sql, values);
}

bool job_exists(SqlTransaction& t, const std::string& id) {
  return !t.run("SELECT id FROM jobs WHERE id = $1", {id}).rows.empty();
}

/// Reads what shards of one phase that are done have stored.
SqlResult select_digests(SqlTransaction& t,
                         const std::string& id,
                         Phase phase,
                         ChunkRange range) {
  return t.run(
      "SELECT first_chunk, digests FROM shards WHERE job_id = $1 AND phase = $2 AND outcome = "
      "1 AND "
      "first_chunk < $4 AND end_chunk > $3 ORDER BY number",
      {id, number_of(phase), range.first, range.end});
}

ChunkDigest digest_at(const std::string& digests, std::int64_t i) {
  return digests.substr(static_cast<std::size_t>(i * kDigestBytes), kDigestBytes);
}

}  // namespace

absl::Status SqlJobStore::number_all_events() {
  std::int64_t numbered = kNumberedAtOnce;
  while (numbered == kNumberedAtOnce) {
    bool any = false;
    auto status = read(*database_, [&](SqlTransaction& t) {
      any = !t.run("SELECT id FROM events WHERE revision = 0 LIMIT 1").rows.empty();
      return absl::OkStatus();
    });
    if (!status.ok() || !any) return status;
    status = number_events(*database_, numbered);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<EventPage> SqlJobStore::read_events(const WatchJobs& query) {
  if (auto status = number_all_events(); !status.ok()) return status;
  EventPage page;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    page = {};
    page.revision = counter(t, "revision");
    if (auto wrong = check_revision(t, query, page.revision); !wrong.ok()) return wrong;
    const SqlResult found = select_events(t, query, page.revision);
    for (const SqlRow& row : found.rows) page.events.push_back(event_of(row));
    if (std::ssize(page.events) == query.limit) page.revision = page.events.back().revision;
    if (!page.events.empty() || query.job.empty()) return absl::OkStatus();
    return job_exists(t, query.job) ? absl::OkStatus() : job_not_found(query.job);
  });
  if (!status.ok()) return status;
  return page;
}

absl::StatusOr<EventPage> SqlJobStore::watch(const WatchJobs& query) {
  if (auto status = check(query); !status.ok()) return status;
  const auto begin = std::chrono::steady_clock::now();
  while (true) {
    const std::uint64_t seen = database_->signal();
    auto page = read_events(query);
    const absl::Duration rest =
        query.wait - absl::FromChrono(std::chrono::steady_clock::now() - begin);
    if (!page.ok() || !page->events.empty() || rest <= absl::ZeroDuration()) return page;
    database_->wait(seen, rest);
  }
}

absl::StatusOr<std::int64_t> SqlJobStore::revision() {
  if (auto status = number_all_events(); !status.ok()) return status;
  std::int64_t last = 0;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    last = counter(t, "revision");
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return last;
}

absl::StatusOr<std::map<std::int64_t, ChunkDigest>> SqlJobStore::chunk_digests(
    const std::string& id, ChunkRange range) {
  std::map<std::int64_t, ChunkDigest> digests;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    digests.clear();
    const auto job = t.run("SELECT chunk_count FROM jobs WHERE id = $1", {id});
    if (job.rows.empty()) return job_not_found(id);
    const std::int64_t count = job.rows[0].integer(0);
    if (range.first < 0 || range.end < range.first || range.end > count) {
      return out_of_range(absl::StrCat("chunks [", range.first, ", ", range.end,
                                       ") are not within [0, ", count, ")"),
                          "RANGE_BEYOND_MESH");
    }
    for (const SqlRow& row : select_digests(t, id, Phase::kMesh, range).rows) {
      const std::int64_t first = bounded(row.integer(0), 0, kMostChunks);
      const std::int64_t end = first + std::ssize(row.blob(1)) / kDigestBytes;
      for (auto c = std::max(first, range.first); c < std::min(end, range.end); ++c) {
        digests[c] = digest_at(row.blob(1), c - first);
      }
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return digests;
}

absl::StatusOr<std::vector<ChunkDigest>> SqlJobStore::count_digests(const std::string& id) {
  std::vector<ChunkDigest> digests;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    digests.clear();
    if (!job_exists(t, id)) return job_not_found(id);
    const auto found = select_digests(t, id, Phase::kCount, {0, INT64_MAX});
    for (const SqlRow& row : found.rows) {
      for (std::int64_t i = 0; i < std::ssize(row.blob(1)) / kDigestBytes; ++i) {
        digests.push_back(digest_at(row.blob(1), i));
      }
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return digests;
}

absl::StatusOr<std::vector<DeadLetter>> SqlJobStore::dead_letters(const std::string& id) {
  std::vector<DeadLetter> letters;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    letters.clear();
    if (!job_exists(t, id)) return job_not_found(id);
    const auto found = t.run(
        "SELECT phase, number, first_chunk, end_chunk, attempts, worker, error, time_us FROM "
        "shards "
        "WHERE job_id = $1 AND outcome = 2 ORDER BY phase, number",
        {id});
    for (const SqlRow& row : found.rows) {
      letters.push_back({{id, phase_from(row.integer(0)), row.integer(1)},
                         range_from(row.integer(2), row.integer(3)),
                         bounded(row.integer(4), 0, kMaxAttempts),
                         row.text(5),
                         decode_status(row.blob(6)),
                         from_us(row.integer(7))});
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return letters;
}

}  // namespace tet
