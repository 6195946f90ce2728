#include "server/jobs/store/sqlite_connection.h"

#include <cerrno>
#include <chrono>
#include <iterator>
#include <thread>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/posix/file.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

// Every commit is flushed before it is acknowledged: with NORMAL, a write-ahead log may lose
// the last commits when the power fails, and a job that was acknowledged would be gone.
constexpr char kSettings[] =
    "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA journal_size_limit = "
    "67108864; "
    "PRAGMA temp_store = MEMORY; PRAGMA cache_size = -4096";

// SQLite's own handler waits up to 100 ms between tries; commits take about one.
constexpr auto kBusyStep = std::chrono::milliseconds(1);

int wait_for_lock(void* most_steps, int steps) {
  if (steps >= *static_cast<const int*>(most_steps)) return 0;
  std::this_thread::sleep_for(kBusyStep);
  return 1;
}

constexpr char kFull[] = "the disk of the jobs' database is full";

/// By trying: SQLite forgets why a file could not be made. Not with the database's own file,
/// since closing that would end this process's locks on it.
bool is_on_a_full_disk(const std::string& database) {
  const std::string probe = database + ".probe";
  auto file = File::open(probe, O_WRONLY | O_CREAT, io_error, 0600);
  absl::Status fits = file.status();
  if (fits.ok()) fits = file->append(std::string(4096, '.'));
  ::unlink(probe.c_str());
  return absl::IsResourceExhausted(fits);
}

void bind(sqlite3_stmt* statement, int index, const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    sqlite3_bind_int64(statement, index, *integer);
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    sqlite3_bind_text64(statement, index, text->data(), text->size(), SQLITE_STATIC,
                        SQLITE_UTF8);
  } else {
    const std::string& bytes = std::get<Blob>(value).bytes;
    sqlite3_bind_blob64(statement, index, bytes.data(), bytes.size(), SQLITE_STATIC);
  }
}

void bind_all(sqlite3_stmt* statement, std::span<const SqlValue> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int index = sqlite3_bind_parameter_index(statement, absl::StrCat("$", i + 1).c_str());
    bind(statement, index, values[i]);
  }
}

SqlValue column(sqlite3_stmt* statement, int i) {
  switch (sqlite3_column_type(statement, i)) {
    case SQLITE_TEXT: {
      const auto* text = static_cast<const void*>(sqlite3_column_text(statement, i));
      return std::string(static_cast<const char*>(text),
                         static_cast<std::size_t>(sqlite3_column_bytes(statement, i)));
    }
    case SQLITE_BLOB: {
      const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement, i));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, i));
      return Blob{size == 0 ? std::string() : std::string(bytes, size)};
    }
    default:
      return sqlite3_column_int64(statement, i);
  }
}

SqlRow row_of(sqlite3_stmt* statement) {
  std::vector<SqlValue> values;
  const int columns = sqlite3_column_count(statement);
  values.reserve(static_cast<std::size_t>(columns));
  for (int i = 0; i < columns; ++i) {
    values.push_back(column(statement, i));
  }
  return SqlRow(std::move(values));
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteConnection>> SqliteConnection::open(
    const SqliteOptions& options) {
  sqlite3* database = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(options.path.c_str(), &database, flags, nullptr);
  std::unique_ptr<SqliteConnection> connection(new SqliteConnection(database, options));
  if (code != SQLITE_OK) return connection->error("opening the jobs' database");
  sqlite3_busy_handler(database, wait_for_lock, &connection->most_busy_steps_);
  if (auto status = connection->set_up(); !status.ok()) return status;
  return connection;
}

absl::Status SqliteConnection::set_up() {
  // SQLite does not wait for others that change a new file's journal at the same time.
  absl::Status status = run_script(kSettings);
  for (int steps = 0; absl::IsUnavailable(status) && steps < most_busy_steps_; ++steps) {
    std::this_thread::sleep_for(kBusyStep);
    status = run_script(kSettings);
  }
  return status;
}

absl::Status SqliteConnection::error(const std::string& action) const {
  const std::string message = absl::StrCat(action, ": ", sqlite3_errmsg(database_.get()));
  switch (sqlite3_errcode(database_.get())) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return store_unavailable(message);
    case SQLITE_FULL:
      return store_full(kFull);
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
      return is_on_a_full_disk(path_) ? store_full(kFull) : store_broken(message);
    default:
      return store_broken(message);
  }
}

absl::Status SqliteConnection::run_script(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) {
    return absl::OkStatus();
  }
  return error(sql.substr(0, 40));
}

absl::StatusOr<sqlite3_stmt*> SqliteConnection::prepare(std::string_view sql) {
  if (const Statement* known = statements_.find(sql)) return known->get();
  if (statements_.is_full()) statements_.drop_oldest();
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v3(database_.get(), sql.data(), static_cast<int>(sql.size()),
                         SQLITE_PREPARE_PERSISTENT, &prepared, nullptr) != SQLITE_OK) {
    return error(std::string(sql));
  }
  return statements_.add(sql, Statement(prepared)).get();
}

int SqliteConnection::count_prepared() const {
  int count = 0;
  for (sqlite3_stmt* one = nullptr;
       (one = sqlite3_next_stmt(database_.get(), one)) != nullptr;) {
    ++count;
  }
  return count;
}

absl::StatusOr<SqlResult> SqliteConnection::run(std::string_view sql,
                                                std::span<const SqlValue> values) {
  const auto statement = prepare(sql);
  if (!statement.ok()) return statement.status();
  bind_all(*statement, values);
  SqlResult result;
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(*statement)) == SQLITE_ROW)
    result.rows.push_back(row_of(*statement));
  // Statements that only read leave the count as the last one that wrote has set it.
  if (sqlite3_stmt_readonly(*statement) == 0) {
    result.changed = sqlite3_changes64(database_.get());
  }
  const absl::Status status = code == SQLITE_DONE ? absl::OkStatus() : error(std::string(sql));
  sqlite3_reset(*statement);
  sqlite3_clear_bindings(*statement);
  if (!status.ok()) return status;
  return result;
}

absl::StatusOr<std::int64_t> SqliteConnection::begin() {
  // IMMEDIATE takes the lock now: a reader that became a writer could be refused halfway.
  const auto begun = run("BEGIN IMMEDIATE", {});
  if (!begun.ok()) return begun.status();
  return absl::ToUnixMicros(clock_());
}

absl::Status SqliteConnection::commit() {
  const auto committed = run("COMMIT", {});
  if (committed.ok()) return absl::OkStatus();
  roll_back();
  return committed.status();
}

void SqliteConnection::roll_back() noexcept {
  // A failure of the disk may have rolled back already.
  if (sqlite3_get_autocommit(database_.get()) == 0) {
    sqlite3_exec(database_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

}  // namespace tet
