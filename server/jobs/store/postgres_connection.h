// One connection to PostgreSQL.
#pragma once

#include <cstdint>
#include <libpq-fe.h>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/store/idle_in_transaction.h"
#include "server/jobs/store/sql.h"
#include "server/jobs/store/statement_cache.h"

namespace tet {

class PostgresConnection final : public SqlConnection {
 public:
  /// A transaction in which nothing is asked for longer than `idle_in_transaction` is ended
  /// with its connection. Errors: kUnavailable.
  static absl::StatusOr<std::unique_ptr<PostgresConnection>> open(
      const std::string& connection, absl::Duration idle_in_transaction = kIdleInTransaction);

  absl::StatusOr<SqlResult> run(std::string_view sql,
                                std::span<const SqlValue> values) override;
  absl::StatusOr<std::int64_t> begin() override;
  absl::Status commit() override;
  void roll_back() noexcept override;
  bool usable() const override;
  bool survived() const override;

  /// Runs statements without parameters, not prepared.
  absl::StatusOr<SqlResult> run_script(const std::string& sql);
  /// Drops what was notified; says whether there was anything. Errors: kUnavailable.
  absl::StatusOr<bool> take_notifications();
  /// The socket, on which to poll for what the server sends.
  int socket() const { return PQsocket(connection_.get()); }

 private:
  struct Close {
    void operator()(PGconn* connection) const { PQfinish(connection); }
  };

  explicit PostgresConnection(PGconn* connection) : connection_(connection) {}
  absl::StatusOr<std::string> prepare(std::string_view sql, std::span<const SqlValue> values);
  absl::StatusOr<SqlResult> result_of(PGresult* raw);
  absl::Status error(const PGresult* result) const;

  const std::unique_ptr<PGconn, Close> connection_;
  StatementCache<std::string> statements_;  ///< their names
  std::uint64_t prepared_ = 0;              ///< so far: no name is given twice
};

}  // namespace tet
