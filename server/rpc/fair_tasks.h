// Short tasks of many clients on the threads of one pool.
#pragma once

#include <functional>
#include <mutex>
#include <string>

#include "core/base/fair_queue.h"
#include "core/base/parallel.h"
#include "server/rpc/client_use.h"

namespace tet {

/// Runs short tasks of many clients on one pool. The next is a task of the client whose tasks
/// have had its threads for the shortest time in all; see FairQueue. What is posted to the pool
/// itself waits for all tasks that were posted before it, whosever they are: what a client has
/// asked for comes here.
///
/// Thread safety: any thread may call `post`. The pool's tasks must have ended before this is
/// destroyed.
class FairTasks {
 public:
  /// The time of tasks is counted in `use`, unless that is null.
  explicit FairTasks(TaskPool& pool, ClientUse* use = nullptr) : pool_(pool), use_(use) {}
  void post(const std::string& client, std::function<void()> task);

 private:
  void run_next();

  struct Task {
    std::string client;
    std::function<void()> work;
  };

  TaskPool& pool_;
  ClientUse* const use_;
  std::mutex mutex_;
  FairQueue<Task> waiting_;
};

}  // namespace tet
