// Long work beside short work: each on threads of its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "server/rpc/fair_queue.h"

namespace tet {

/// Runs a few large plans at once, each on a pool of its own, so that neither small requests
/// nor each other wait for their loops: the system shares the cores between the pools. More of
/// them wait, and the clients take turns.
///
/// Thread safety: any thread may call `post`. The destructor waits for all that was posted.
class LargePlans {
 public:
  /// Pools of `threads` (0: every core) each.
  LargePlans(int threads, std::size_t at_once);
  ~LargePlans();

  void post(const std::string& client, std::function<void()> work);

 private:
  void start_waiting();
  void finished(TaskPool* pool);

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable all_idle_;
  FairQueue<std::function<void()>> waiting_;
  std::vector<TaskPool*> idle_;
  std::vector<std::unique_ptr<TaskPool>> pools_;
};

}  // namespace tet
