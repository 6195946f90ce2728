// Short tasks of many clients on the threads of one pool.
#pragma once

#include <functional>
#include <mutex>
#include <string>

#include "core/base/parallel.h"
#include "server/rpc/fair_queue.h"

namespace tet {

/// Runs short tasks of many clients on one pool; the clients take turns, task by task.
///
/// Thread safety: any thread may call `post`. The pool's tasks must have ended before this is
/// destroyed.
class FairTasks {
 public:
  explicit FairTasks(TaskPool& pool) : pool_(pool) {}
  void post(const std::string& client, std::function<void()> task);

 private:
  void run_next();

  TaskPool& pool_;
  std::mutex mutex_;
  FairQueue<std::function<void()>> waiting_;
};

}  // namespace tet
