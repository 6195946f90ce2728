#include "server/jobs/store/sql.h"

namespace tet {

absl::StatusOr<SqlPool::Lease> SqlPool::take() {
  std::unique_ptr<SqlConnection> connection;
  {
    std::unique_lock lock(mutex_);
    returned_.wait(lock, [&] { return room_ > 0; });
    --room_;
    while (!connection && !idle_.empty()) {
      connection = std::move(idle_.back());
      idle_.pop_back();
      if (!connection->survived()) connection.reset();
    }
  }
  const auto back = [this](SqlConnection* used) { give_back(used); };
  if (connection) return Lease(connection.release(), back);
  auto opened = open_();
  if (opened.ok()) return Lease(opened->release(), back);
  give_back(nullptr);
  return opened.status();
}

void SqlPool::give_back(SqlConnection* connection) {
  std::unique_ptr<SqlConnection> owned(connection);
  const std::lock_guard lock(mutex_);
  if (owned && owned->usable()) idle_.push_back(std::move(owned));
  ++room_;
  returned_.notify_one();
}

}  // namespace tet
