#include "server/jobs/store/sql_transaction.h"

#include <variant>

#include "core/base/contain.h"
#include "proto/convert/status.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

/// A row that is not as it should be is an error of the store's, and ends nothing else.
absl::Status run_body(SqlBody body, SqlTransaction& transaction) {
  try {
    return body(transaction);
  } catch (const std::bad_variant_access&) {
    return store_broken("a row of the jobs' database has a column of another type: restore it");
  } catch (...) {
    tell_exception("the job store");
    return store_broken("a row of the jobs' database could not be read: restore it");
  }
}

// Deadlocks are avoided by the order in which rows are locked, so that one try is the rule.
constexpr int kMostTries = 10;

absl::Status try_once(SqlDatabase& database, SqlBody body, bool& give_way) {
  auto connection = database.writer();
  if (!connection.ok()) return connection.status();
  const auto now_us = (*connection)->begin();
  if (!now_us.ok()) return now_us.status();
  database.clock().learn(*now_us);
  SqlTransaction transaction(**connection, database, *now_us);
  const absl::Status outcome = run_body(body, transaction);
  if (transaction.status().ok() && outcome.ok()) {
    const absl::Status committed = (*connection)->commit();
    // Who finds no work waits for news, and would be woken by its own search for ever.
    if (committed.ok() && transaction.has_changed_rows()) database.announce();
    give_way = absl::IsAborted(committed);
    return committed;
  }
  (*connection)->roll_back();
  give_way = absl::IsAborted(transaction.status());
  return transaction.status().ok() ? outcome : transaction.status();
}

absl::Status read_once(SqlDatabase& database, SqlBody body, bool& give_way) {
  auto connection = database.reader();
  if (!connection.ok()) return connection.status();
  SqlTransaction statements(**connection, database, 0);
  const absl::Status outcome = run_body(body, statements);
  give_way = absl::IsAborted(statements.status());
  return statements.status().ok() ? outcome : statements.status();
}

}  // namespace

SqlResult SqlTransaction::run(std::string_view sql, std::span<const SqlValue> values) {
  if (!status_.ok()) return {};
  auto result = connection_.run(sql, values);
  if (!result.ok()) {
    status_ = result.status();
    return {};
  }
  changed_ += result->changed;
  return *std::move(result);
}

std::int64_t SqlTransaction::integer(std::string_view sql,
                                     std::initializer_list<SqlValue> values) {
  const SqlResult result = run(sql, values);
  return result.rows.empty() ? 0 : result.rows[0].integer(0);
}

absl::Status transact(SqlDatabase& database, SqlBody body, Purpose purpose) {
  absl::Status status;
  bool made_room = false;
  for (int tries = 0; tries < kMostTries; ++tries) {
    bool give_way = false;
    status = try_once(database, body, give_way);
    const bool is_full = reason_of(status) == "JOB_STORE_FULL";
    if (is_full && purpose == Purpose::kRoom && database.make_room()) {
      made_room = true;
      continue;
    }
    if (give_way) continue;
    if (made_room) database.retake_room();
    return status;
  }
  return status;
}

absl::Status read(SqlDatabase& database, SqlBody body) {
  absl::Status status;
  for (int tries = 0; tries < kMostTries; ++tries) {
    bool give_way = false;
    status = read_once(database, body, give_way);
    if (!give_way) break;
  }
  return status;
}

}  // namespace tet
