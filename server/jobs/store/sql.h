// What the job store needs of a database: statements with parameters, one connection to write
// with at a time, and being told of commits. Both engines speak the SQL of sql_job_store; where
// their dialects differ, they say how.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

namespace tet {

/// Bytes, where std::string is text.
struct Blob {
  std::string bytes;
};

/// There are no nulls: columns have values that mean none.
using SqlValue = std::variant<std::int64_t, std::string, Blob>;

/// One row of a result. A column of another type than asked for is a bug of ours.
class SqlRow {
 public:
  explicit SqlRow(std::vector<SqlValue> values) : values_(std::move(values)) {}
  std::size_t size() const { return values_.size(); }
  std::int64_t integer(std::size_t column) const {
    return std::get<std::int64_t>(values_[column]);
  }
  const std::string& text(std::size_t column) const {
    return std::get<std::string>(values_[column]);
  }
  const std::string& blob(std::size_t column) const {
    return std::get<Blob>(values_[column]).bytes;
  }

 private:
  std::vector<SqlValue> values_;
};

struct SqlResult {
  std::vector<SqlRow> rows;
  std::int64_t changed = 0;  ///< rows inserted, updated or deleted
};

/// An open connection. Not thread-safe.
class SqlConnection {
 public:
  virtual ~SqlConnection() = default;

  /// Runs one statement, prepared at its first use; parameters are $1, $2, ...
  /// Errors: kUnavailable (busy, connection lost), kAborted (the transaction must be run
  /// again), kResourceExhausted (disk full), kInternal.
  virtual absl::StatusOr<SqlResult> run(std::string_view sql,
                                        std::span<const SqlValue> values) = 0;
  /// Begins a transaction and tells the database's time, microseconds since the epoch.
  virtual absl::StatusOr<std::int64_t> begin() = 0;
  virtual absl::Status commit() = 0;
  virtual void roll_back() noexcept = 0;
  /// Whether it is worth keeping for the next who needs one.
  virtual bool usable() const { return true; }
  /// Whether it still leads to the database after it lay idle, as far as can be told without
  /// asking.
  virtual bool survived() const { return true; }
};

/// Up to `most` connections that are opened when needed and used again. Thread-safe; outlives
/// its leases.
class SqlPool {
 public:
  using Open = std::function<absl::StatusOr<std::unique_ptr<SqlConnection>>()>;
  using Lease = std::unique_ptr<SqlConnection, std::function<void(SqlConnection*)>>;

  SqlPool(int most, Open open) : room_(most), open_(std::move(open)) {}
  /// A connection that nobody else uses until the lease is dropped; waits for one.
  absl::StatusOr<Lease> take();

 private:
  void give_back(SqlConnection* connection);

  std::mutex mutex_;
  std::condition_variable returned_;
  int room_;  ///< connections that may be leased now
  std::vector<std::unique_ptr<SqlConnection>> idle_;
  const Open open_;
};

/// The database's time between its answers: what it said last, and what has passed since by
/// this machine's monotonic clock. Thread-safe.
class StoreClock {
 public:
  void learn(std::int64_t now_us) { ahead_us_ = now_us - monotonic_us(); }
  /// The infinite past while nothing was learned.
  absl::Time now() const {
    const std::int64_t ahead_us = ahead_us_;
    if (ahead_us == kUnknown) return absl::InfinitePast();
    return absl::FromUnixMicros(monotonic_us() + ahead_us);
  }

 private:
  static constexpr std::int64_t kUnknown = INT64_MIN;
  static std::int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  std::atomic<std::int64_t> ahead_us_{kUnknown};  ///< of the monotonic clock
};

/// Hands out connections. Thread-safe.
class SqlDatabase {
 public:
  virtual ~SqlDatabase() = default;

  StoreClock& clock() { return clock_; }

  virtual absl::StatusOr<SqlPool::Lease> reader() = 0;
  virtual absl::StatusOr<SqlPool::Lease> writer() = 0;

  /// Ends of SELECT: rows stay as they are until the transaction ends; rows that others hold
  /// are waited for, or left out. Empty where there is one writer.
  virtual const char* for_update() const = 0;
  virtual const char* skip_locked() const = 0;
  /// A statement that gives the next fencing token.
  virtual const char* next_token() const = 0;

  /// Gives up what was kept for a disk that is full, so that what ends or forgets jobs can be
  /// written. False where nothing is kept any more.
  virtual bool make_room() { return false; }
  /// Keeps something again: if there is room enough, or after it was made, whatever there is.
  virtual void keep_room() {}
  virtual void retake_room() {}

  /// Tells waiters everywhere that changes were committed.
  virtual void announce() = 0;
  virtual std::uint64_t signal() = 0;
  virtual void wait(std::uint64_t seen, absl::Duration timeout) = 0;
  /// Tells those in this process to look again.
  virtual void wake_all() = 0;

  /// Forgets what finished before, in the way that is cheapest for the engine; says how many
  /// jobs.
  virtual absl::StatusOr<std::int64_t> purge(std::int64_t finished_before_us) = 0;

 private:
  StoreClock clock_;
};

}  // namespace tet
