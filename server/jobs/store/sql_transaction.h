// A transaction that remembers its first error, so that statements read one after another.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include <absl/functional/function_ref.h>
#include <absl/status/status.h>

#include "server/jobs/store/sql.h"

namespace tet {

/// After a statement has failed, all later ones do nothing and have no rows; `status` says why,
/// and whatever the body made of the missing rows is dropped with the transaction.
class SqlTransaction {
 public:
  SqlTransaction(SqlConnection& connection, const SqlDatabase& dialect, std::int64_t now_us)
      : connection_(connection), dialect_(dialect), now_us_(now_us) {}

  SqlResult run(std::string_view sql, std::span<const SqlValue> values);
  SqlResult run(std::string_view sql, std::initializer_list<SqlValue> values = {}) {
    return run(sql, std::span(values.begin(), values.size()));
  }
  /// The first column of the first row; 0 without one.
  std::int64_t integer(std::string_view sql, std::initializer_list<SqlValue> values = {});

  const SqlDatabase& dialect() const { return dialect_; }
  /// The database's time when the transaction began, microseconds since the epoch.
  std::int64_t now_us() const { return now_us_; }
  const absl::Status& status() const { return status_; }
  bool has_changed_rows() const { return changed_ > 0; }

 private:
  SqlConnection& connection_;
  const SqlDatabase& dialect_;
  const std::int64_t now_us_;
  absl::Status status_;
  std::int64_t changed_ = 0;
};

using SqlBody = absl::FunctionRef<absl::Status(SqlTransaction&)>;

/// What a transaction is for, where the disk is full.
enum class Purpose {
  kWork,  ///< fails
  kRoom,  ///< ends or forgets something: the reserve of the database is there for it
};

/// Runs the body and commits, if it returns OK and no statement failed; else nothing has
/// happened, unless the error is kUnavailable: then it may have. Waiters are told if rows were
/// changed. A body that the database made
/// to give way to another is run again, so it must only set what is outside of it.
absl::Status transact(SqlDatabase& database, SqlBody body, Purpose purpose = Purpose::kWork);

/// Runs statements that only read, each for itself. A body of which one had to give way is run
/// again from its beginning, as by `transact`, so that it must set, and not add to, what is
/// outside of it.
absl::Status read(SqlDatabase& database, SqlBody body);

}  // namespace tet
