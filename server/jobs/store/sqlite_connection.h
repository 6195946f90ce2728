// One connection to an SQLite file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <sqlite3.h>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/jobs/store/sql.h"
#include "server/jobs/store/sqlite_job_store.h"
#include "server/jobs/store/statement_cache.h"

namespace tet {

class SqliteConnection final : public SqlConnection {
 public:
  static absl::StatusOr<std::unique_ptr<SqliteConnection>> open(const SqliteOptions& options);

  absl::StatusOr<SqlResult> run(std::string_view sql,
                                std::span<const SqlValue> values) override;
  absl::StatusOr<std::int64_t> begin() override;
  absl::Status commit() override;
  void roll_back() noexcept override;

  /// Runs statements without parameters or rows.
  absl::Status run_script(const std::string& sql);
  /// How many statements SQLite has prepared for it.
  int count_prepared() const;

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

  SqliteConnection(sqlite3* database, const SqliteOptions& options)
      : path_(options.path),
        database_(database),
        clock_(options.clock),
        most_busy_steps_(static_cast<int>(absl::ToInt64Milliseconds(options.busy_timeout))) {}
  absl::Status set_up();
  absl::StatusOr<sqlite3_stmt*> prepare(std::string_view sql);
  absl::Status error(const std::string& action) const;

  const std::string path_;
  const std::unique_ptr<sqlite3, Close> database_;
  const std::function<absl::Time()> clock_;
  int most_busy_steps_;                   ///< of a millisecond
  StatementCache<Statement> statements_;  ///< dropped before the database
};

}  // namespace tet
