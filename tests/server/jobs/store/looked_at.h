// How much databases look at: what a test counts that would measure their time otherwise.
#pragma once

#include <atomic>
#include <cstdint>
#include <sqlite3.h>
#include <stdexcept>
#include <string>

#include "server/jobs/store/postgres_connection.h"
#include "tests/support/eventually.h"

namespace tet::test {

/// Steps of the programs that SQLite makes of statements, in this process, on connections that
/// are opened while this exists. One at a time.
class SqliteSteps {
 public:
  SqliteSteps() { sqlite3_auto_extension(reinterpret_cast<void (*)()>(&watch)); }
  ~SqliteSteps() { sqlite3_cancel_auto_extension(reinterpret_cast<void (*)()>(&watch)); }
  SqliteSteps(const SqliteSteps&) = delete;
  SqliteSteps& operator=(const SqliteSteps&) = delete;

  static std::int64_t count() { return counter(); }

 private:
  static std::atomic<std::int64_t>& counter() {
    static std::atomic<std::int64_t> steps{0};
    return steps;
  }
  static int watch(sqlite3* database, char** /*error*/, const void* /*routines*/) {
    return sqlite3_trace_v2(database, SQLITE_TRACE_PROFILE, &add, nullptr);
  }
  /// A statement has ended.
  static int add(unsigned /*kind*/, void* /*ours*/, void* statement, void* /*time*/) {
    counter() += sqlite3_stmt_status(static_cast<sqlite3_stmt*>(statement),
                                     SQLITE_STMTSTATUS_VM_STEP, /*reset=*/1);
    return 0;
  }
};

/// Rows and entries of indexes that PostgreSQL has read of the tables of a schema. A server
/// process tells of all it has read when its connection ends: this waits until there is no
/// other one.
inline std::int64_t postgres_rows_read(const std::string& connection) {
  const auto look = PostgresConnection::open(connection).value();
  const auto number = [&](const char* sql) {
    return look->run(sql, {}).value().rows.at(0).integer(0);
  };
  const bool alone = eventually([&] {
    return number(
               "SELECT count(*) FROM pg_stat_activity WHERE backend_type = 'client backend' "
               "AND "
               "pid <> pg_backend_pid()") == 0;
  });
  if (!alone) throw std::runtime_error("a connection to PostgreSQL stays open");
  return number(
      "SELECT CAST((SELECT COALESCE(sum(seq_tup_read), 0) FROM pg_stat_user_tables WHERE "
      "schemaname = current_schema) + (SELECT COALESCE(sum(idx_tup_read), 0) FROM "
      "pg_stat_user_indexes WHERE schemaname = current_schema) AS BIGINT)");
}

}  // namespace tet::test
