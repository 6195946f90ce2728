#include "server/jobs/store/postgres_job_store.h"

#include <mutex>
#include <string>
#include <utility>

#include "server/jobs/store/postgres_connection.h"
#include "server/jobs/store/postgres_listener.h"
#include "server/jobs/store/postgres_schema.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

class PostgresDatabase final : public SqlDatabase {
 public:
  explicit PostgresDatabase(const PostgresOptions& options)
      : address_(options.connection),
        idle_in_transaction_(options.idle_in_transaction),
        partition_(options.partition),
        connections_(options.max_connections, [this] { return connect(); }),
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
  void wake_all() override { listener_.raise(); }

  absl::StatusOr<std::int64_t> purge(std::int64_t finished_before_us) override {
    const auto connection = connections_.take();
    if (!connection.ok()) return connection.status();
    auto& postgres = static_cast<PostgresConnection&>(**connection);
    if (auto made = make_partitions(postgres, partition_); !made.ok()) return made;
    return drop_partitions(postgres, finished_before_us);
  }

 private:
  absl::StatusOr<std::unique_ptr<SqlConnection>> connect();

  const std::string address_;
  const absl::Duration idle_in_transaction_;
  const absl::Duration partition_;
  std::mutex schema_mutex_;
  bool is_up_to_date_ = false;
  SqlPool connections_;
  PostgresListener listener_;
};

/// The first connection of all brings the schema up to date.
absl::StatusOr<std::unique_ptr<SqlConnection>> PostgresDatabase::connect() {
  auto connection = PostgresConnection::open(address_, idle_in_transaction_);
  if (!connection.ok()) return connection.status();
  const std::lock_guard lock(schema_mutex_);
  if (!is_up_to_date_) {
    if (auto status = migrate_postgres(**connection); !status.ok()) return status;
    if (auto made = make_partitions(**connection, partition_); !made.ok()) return made;
    is_up_to_date_ = true;
  }
  return connection;
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobStore>> open_postgres_job_store(
    const PostgresOptions& options) {
  auto database = std::make_unique<PostgresDatabase>(options);
  const absl::Status opened = database->reader().status();
  if (!opened.ok() && !(options.patient && will_pass(opened))) return opened;
  return std::make_unique<SqlJobStore>(std::move(database), options.rules);
}

}  // namespace tet
