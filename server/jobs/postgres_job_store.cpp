#include "server/jobs/postgres_job_store.h"

#include <utility>

#include "server/jobs/postgres_connection.h"
#include "server/jobs/postgres_listener.h"
#include "server/jobs/postgres_schema.h"

namespace tet {

namespace {

class PostgresDatabase final : public SqlDatabase {
 public:
  explicit PostgresDatabase(const PostgresOptions& options)
      : partition_(options.partition),
        connections_(
            options.max_connections,
            [connection = options.connection] { return PostgresConnection::open(connection); }),
        listener_(options.connection, options.poll) {}

  absl::StatusOr<SqlPool::Lease> reader() override { return connections_.take(); }
  absl::StatusOr<SqlPool::Lease> writer() override { return connections_.take(); }

  const char* for_update() const override { return " FOR UPDATE"; }
  const char* skip_locked() const override { return " FOR UPDATE SKIP LOCKED"; }
  const char* next_token() const override { return "SELECT nextval('tokens')"; }

  void announce() override { listener_.announce(); }
  std::uint64_t signal() override { return listener_.signal(); }
  void wait(std::uint64_t seen, absl::Duration timeout) override {
    listener_.wait(seen, timeout);
  }

  absl::StatusOr<std::int64_t> purge(std::int64_t finished_before_us) override {
    const auto connection = connections_.take();
    if (!connection.ok()) return connection.status();
    auto& postgres = static_cast<PostgresConnection&>(**connection);
    if (auto made = make_partitions(postgres, partition_); !made.ok()) return made;
    return drop_partitions(postgres, finished_before_us);
  }

 private:
  const absl::Duration partition_;
  SqlPool connections_;
  PostgresListener listener_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<JobStore>> open_postgres_job_store(
    const PostgresOptions& options) {
  // Before anything listens: a wrong address is told at once.
  const auto connection = PostgresConnection::open(options.connection);
  if (!connection.ok()) return connection.status();
  if (auto status = migrate_postgres(**connection); !status.ok()) return status;
  if (auto status = make_partitions(**connection, options.partition); !status.ok())
    return status;
  return std::make_unique<SqlJobStore>(std::make_unique<PostgresDatabase>(options),
                                       options.rules);
}

}  // namespace tet
