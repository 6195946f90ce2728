// Commits of all processes that share a database: told by NOTIFY, and looked for in any case.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <absl/time/time.h>

#include "core/base/posix/wake_event.h"
#include "server/jobs/store/postgres_connection.h"

namespace tet {

/// One thread and one connection. NOTIFY belongs to no transaction of the store's: PostgreSQL
/// takes a lock for the whole of a commit that notifies, and so all of them would commit one by
/// one. What is lost when a process dies between its commit and its notification is found by
/// the poll.
class PostgresListener {
 public:
  PostgresListener(std::string connection, absl::Duration poll);
  ~PostgresListener();

  /// Tells this process at once, and all others soon.
  void announce();
  std::uint64_t signal();
  void wait(std::uint64_t seen, absl::Duration timeout);
  /// Tells this process alone.
  void raise();

 private:
  void run();
  bool tell_and_listen();
  bool listen();
  void listen_once();

  const std::string connection_string_;
  const absl::Duration poll_;
  std::mutex mutex_;
  std::condition_variable raised_;
  std::uint64_t signal_ = 0;
  bool pending_ = false;  ///< others are still to be told
  bool stopping_ = false;
  WakeEvent wake_;                                  ///< ends the thread's poll
  std::unique_ptr<PostgresConnection> connection_;  ///< the thread's
  std::thread thread_;
};

}  // namespace tet
