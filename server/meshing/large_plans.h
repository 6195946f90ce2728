// Long work beside short work: each on threads of its own.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/fair_queue.h"
#include "core/base/parallel.h"
#include "server/rpc/client_use.h"

namespace tet {

/// Runs a few large plans at once, each on a pool of its own, so that neither small requests
/// nor each other wait for their loops: the system shares the cores between the pools. More of
/// them wait, and the next is of the client who has had pools for the shortest time in all;
/// see FairQueue. All jobs together leave one pool to others, unless it is the only one.
///
/// Thread safety: any thread may call `post`. The destructor waits for all that was posted.
class LargePlans {
 public:
  /// Pools of `threads` (0: every core) each; one client has at most so many of them. The time
  /// of plans is counted in `use`, unless that is null.
  LargePlans(int threads,
             std::size_t at_once,
             std::size_t of_client = SIZE_MAX,
             ClientUse* use = nullptr);
  ~LargePlans();

  void post(const std::string& client, std::function<void()> work);

 private:
  void start_waiting();
  bool may_start(const std::string& client) const;
  void finished(TaskPool* pool, const std::string& client, std::chrono::nanoseconds use);

  const std::size_t of_client_;
  ClientUse* const use_;
  std::mutex mutex_;  ///< guards what follows
  std::condition_variable all_idle_;
  struct Waiting {
    std::string client;
    std::function<void()> work;
  };
  FairQueue<Waiting> waiting_;
  std::map<std::string, std::size_t> running_;  ///< clients that have pools
  std::vector<TaskPool*> idle_;
  std::vector<std::unique_ptr<TaskPool>> pools_;
};

}  // namespace tet
