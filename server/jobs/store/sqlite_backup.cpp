#include "server/jobs/store/sqlite_backup.h"

#include <chrono>
#include <memory>
#include <sqlite3.h>
#include <string>
#include <thread>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include "core/base/posix/file.h"
#include "core/base/posix/folder.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

namespace fs = std::filesystem;

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

// Another process's checkpoint, or a writer of the copy's moment.
constexpr int kBusyTries = 100;
constexpr std::chrono::milliseconds kBusyPause{100};

absl::Status failure(sqlite3* database, const char* action) {
  const std::string message = absl::StrCat(action, ": ", sqlite3_errmsg(database));
  switch (sqlite3_errcode(database)) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return store_unavailable(message);
    case SQLITE_FULL:
      return store_full(message);
    default:
      return store_broken(message);
  }
}

absl::StatusOr<Database> open_database(const fs::path& path, int flags) {
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &opened, flags, nullptr);
  Database database(opened);
  if (code != SQLITE_OK) return failure(opened, "opening the jobs' database");
  sqlite3_busy_timeout(opened, 10'000);
  return database;
}

absl::Status run_sql(sqlite3* database, const char* sql) {
  if (sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK) {
    return absl::OkStatus();
  }
  return failure(database, sql);
}

/// All pages in one step: within it nobody else's commit is seen.
absl::Status copy_pages(sqlite3* from, sqlite3* to) {
  sqlite3_backup* const backup = sqlite3_backup_init(to, "main", from, "main");
  if (backup == nullptr) return failure(to, "beginning the copy");
  int code = SQLITE_BUSY;
  for (int tries = 0; tries < kBusyTries; ++tries) {
    code = sqlite3_backup_step(backup, -1);
    if (code != SQLITE_BUSY && code != SQLITE_LOCKED) break;
    std::this_thread::sleep_for(kBusyPause);
  }
  sqlite3_backup_finish(backup);
  return code == SQLITE_DONE ? absl::OkStatus() : failure(to, "copying the jobs' database");
}

absl::Status copy_to(sqlite3* from, const fs::path& part) {
  auto to = open_database(part, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  if (!to.ok()) return to.status();
  if (auto copied = copy_pages(from, to->get()); !copied.ok()) return copied;
  // One file, without a log beside it.
  return run_sql(to->get(), "PRAGMA journal_mode = DELETE");
}

absl::Status flush(const fs::path& path) {
  auto file = File::open(path, O_RDWR, io_error);
  return file.ok() ? file->sync() : file.status();
}

/// Rows of text, all columns of each.
absl::StatusOr<std::vector<std::vector<std::string>>> select_text(const fs::path& path,
                                                                  const char* sql) {
  auto database = open_database(path, SQLITE_OPEN_READWRITE);
  if (!database.ok()) return database.status();
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(database->get(), sql, -1, &prepared, nullptr) != SQLITE_OK) {
    return failure(database->get(), sql);
  }
  const std::unique_ptr<sqlite3_stmt, FinalizeStatement> statement(prepared);
  std::vector<std::vector<std::string>> rows;
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(prepared)) == SQLITE_ROW) {
    std::vector<std::string>& row = rows.emplace_back();
    for (int i = 0; i < sqlite3_column_count(prepared); ++i) {
      const auto* text = static_cast<const void*>(sqlite3_column_text(prepared, i));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(prepared, i));
      row.emplace_back(static_cast<const char*>(text), size);
    }
  }
  if (code != SQLITE_DONE) return failure(database->get(), sql);
  return rows;
}

}  // namespace

absl::Status back_up_sqlite(const fs::path& from, const fs::path& to) {
  std::error_code ignored;
  if (!fs::exists(from, ignored)) {
    return absl::NotFoundError(absl::StrCat("there are no jobs in ", from.string()));
  }
  auto source = open_database(from, SQLITE_OPEN_READWRITE);
  if (!source.ok()) return source.status();
  const fs::path part = to.string() + ".part";
  fs::remove(part, ignored);
  absl::Status status = copy_to(source->get(), part);
  if (status.ok()) status = flush(part);
  if (status.ok()) return move_file(part, to, io_error);
  fs::remove(part, ignored);
  return status;
}

absl::Status check_sqlite(const fs::path& database) {
  const auto rows = select_text(database, "PRAGMA integrity_check(10)");
  if (!rows.ok()) return rows.status();
  if (rows->size() == 1 && rows->front().front() == "ok") return absl::OkStatus();
  std::string found;
  for (const auto& row : *rows) absl::StrAppend(&found, found.empty() ? "" : "; ", row.front());
  return store_broken(absl::StrCat("the jobs' database is damaged: ", found));
}

absl::StatusOr<std::set<JobInput>> inputs_of_sqlite(const fs::path& database) {
  const auto rows = select_text(
      database, "SELECT DISTINCT space, input FROM jobs WHERE state <= 2 AND input <> ''");
  if (!rows.ok()) return rows.status();
  std::set<JobInput> inputs;
  for (const auto& row : *rows) {
    for (const absl::string_view name : absl::StrSplit(row[1], ' ')) {
      inputs.insert({row[0], std::string(name)});
    }
  }
  return inputs;
}

}  // namespace tet
