#include "server/jobs/store/sqlite_job_store.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/jobs/store/ballast.h"
#include "server/jobs/store/sql_transaction.h"
#include "server/jobs/store/sqlite_connection.h"
#include "server/jobs/store/sqlite_schema.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

constexpr int kReaders = 4;
// How soon another process's commits are seen; asking costs microseconds.
constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr auto kBetweenTries = std::chrono::seconds(1);
constexpr std::int64_t kPurgedAtOnce = 500;

bool is_in_memory(const SqliteOptions& options) { return options.path == ":memory:"; }

/// Tells when something was committed: at once when this process did it, and by looking when
/// another did.
class CommitSignal {
 public:
  using Open = std::function<absl::StatusOr<std::unique_ptr<SqliteConnection>>()>;
  /// An empty `open` says that there are no other processes.
  explicit CommitSignal(Open open) : open_(std::move(open)) {}

  void raise() {
    const std::lock_guard lock(mutex_);
    ++signal_;
    raised_.notify_all();
  }

  std::uint64_t now() {
    const std::lock_guard lock(mutex_);
    look();
    return signal_;
  }

  void wait(std::uint64_t seen, absl::Duration timeout) {
    const auto end = std::chrono::steady_clock::now() + absl::ToChronoNanoseconds(timeout);
    std::unique_lock lock(mutex_);
    for (look(); signal_ == seen; look()) {
      const auto now = std::chrono::steady_clock::now();
      if (now >= end) return;
      raised_.wait_until(lock, std::min(end, now + kPoll));
    }
  }

 private:
  void look() {
    SqliteConnection* const connection = connect();
    if (connection == nullptr) return;
    const auto found = connection->run("PRAGMA data_version", {});
    if (!found.ok() || found->rows[0].integer(0) == version_) return;
    version_ = found->rows[0].integer(0);
    ++signal_;
  }

  // Null while there is none.
  SqliteConnection* connect() {
    const auto now = std::chrono::steady_clock::now();
    if (connection_ || !open_ || now < next_try_) return connection_.get();
    auto opened = open_();
    if (opened.ok()) connection_ = *std::move(opened);
    next_try_ = now + kBetweenTries;
    return connection_.get();
  }

  std::mutex mutex_;
  std::condition_variable raised_;
  std::uint64_t signal_ = 0;
  std::int64_t version_ = 0;
  const Open open_;
  std::unique_ptr<SqliteConnection> connection_;
  std::chrono::steady_clock::time_point next_try_{};
};

class SqliteDatabase final : public SqlDatabase {
 public:
  explicit SqliteDatabase(const SqliteOptions& options)
      : options_(options),
        in_memory_(is_in_memory(options)),
        ballast_(options.path + ".ballast", in_memory_ ? 0 : options.ballast_bytes),
        writers_(1, [this] { return connect(); }),
        readers_(kReaders, [this] { return connect(); }),
        signal_(in_memory_ ? CommitSignal::Open()
                           : [options] { return SqliteConnection::open(options); }) {}

  absl::StatusOr<SqlPool::Lease> reader() override {
    return in_memory_ ? writers_.take() : readers_.take();
  }
  absl::StatusOr<SqlPool::Lease> writer() override { return writers_.take(); }

  const char* for_update() const override { return ""; }
  const char* skip_locked() const override { return ""; }
  const char* next_token() const override {
    return "UPDATE counters SET value = value + 1 WHERE name = 'token' RETURNING value";
  }

  bool make_room() override { return ballast_.drop(); }
  void keep_room() override { ballast_.keep(); }
  void retake_room() override { ballast_.retake(); }

  void announce() override { signal_.raise(); }
  std::uint64_t signal() override { return signal_.now(); }
  void wait(std::uint64_t seen, absl::Duration timeout) override {
    signal_.wait(seen, timeout);
  }
  void wake_all() override { signal_.raise(); }

  absl::StatusOr<std::int64_t> purge(std::int64_t finished_before_us) override;

 private:
  absl::StatusOr<std::unique_ptr<SqlConnection>> connect();

  const SqliteOptions options_;
  const bool in_memory_;
  const Ballast ballast_;
  std::mutex schema_mutex_;
  bool is_up_to_date_ = false;
  SqlPool writers_;
  SqlPool readers_;
  CommitSignal signal_;
};

/// The events of jobs that are gone, if they are old; whoever has not seen them is told.
void purge_events(SqlTransaction& t, std::int64_t before_us) {
  constexpr char kGone[] =
      "FROM events WHERE time_us < $1 AND revision > 0 AND NOT EXISTS (SELECT 1 FROM jobs "
      "WHERE "
      "jobs.id = events.job_id)";
  const std::int64_t last =
      t.integer(absl::StrCat("SELECT COALESCE(max(revision), 0) ", kGone), {before_us});
  t.run(absl::StrCat("DELETE ", kGone), {before_us});
  t.run("UPDATE counters SET value = max(value, $1) WHERE name = 'compacted'", {last});
}

std::int64_t purge_some(SqlTransaction& t, std::int64_t before_us) {
  const auto old = t.run(
      "SELECT id FROM jobs WHERE state >= 3 AND finish_us < $1 ORDER BY finish_us LIMIT $2",
      {before_us, kPurgedAtOnce});
  for (const SqlRow& row : old.rows) {
    t.run("DELETE FROM shards WHERE job_id = $1", {row.text(0)});
    t.run("DELETE FROM requests WHERE job_id = $1", {row.text(0)});
    t.run("DELETE FROM jobs WHERE id = $1", {row.text(0)});
  }
  return std::ssize(old.rows);
}

absl::StatusOr<std::int64_t> SqliteDatabase::purge(std::int64_t finished_before_us) {
  std::int64_t total = 0;
  std::int64_t purged = kPurgedAtOnce;
  while (purged == kPurgedAtOnce) {
    const auto status = transact(
        *this,
        [&](SqlTransaction& t) {
          purged = purge_some(t, finished_before_us);
          if (purged < kPurgedAtOnce) purge_events(t, finished_before_us);
          return absl::OkStatus();
        },
        Purpose::kRoom);
    if (!status.ok()) return status;
    total += purged;
  }
  return total;
}

/// The first connection of all brings the schema up to date.
absl::StatusOr<std::unique_ptr<SqlConnection>> SqliteDatabase::connect() {
  auto connection = SqliteConnection::open(options_);
  // A restart on a full disk: nobody could even look at the jobs.
  if (reason_of(connection.status()) == "JOB_STORE_FULL" && ballast_.drop()) {
    connection = SqliteConnection::open(options_);
    ballast_.retake();
  }
  if (!connection.ok()) return connection.status();
  const std::lock_guard lock(schema_mutex_);
  if (!is_up_to_date_) {
    if (auto status = migrate_sqlite(**connection); !status.ok()) return status;
    is_up_to_date_ = true;
    ballast_.keep();
  }
  return connection;
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobStore>> open_sqlite_job_store(const SqliteOptions& options) {
  auto database = std::make_unique<SqliteDatabase>(options);
  const absl::Status opened = database->writer().status();
  if (!opened.ok() && !(options.patient && will_pass(opened))) return opened;
  return std::make_unique<SqlJobStore>(std::move(database), options.rules);
}

}  // namespace tet
