#include "server/meshing/large_plans.h"

#include <optional>
#include <sys/resource.h>
#include <thread>
#include <utility>

#include "core/base/contain.h"
#include "core/base/own_threads.h"
#include "server/rpc/background.h"

namespace tet {

namespace {

/// Does the work on threads of a lower priority, while the pool's own thread waits for them and
/// keeps the priority of all pools.
std::function<void()> politely(int threads, std::function<void()> work) {
  return [threads, work = std::move(work)] {
    std::jthread([&] {
      contain("background work", [&] {
        give_way();
        run_with_own_threads(threads, work);
      });
    });
  };
}

}  // namespace

void give_way() {
  // On Linux a thread's own; where it fails, only politeness is lost.
  if (::getpriority(PRIO_PROCESS, 0) >= kBackgroundNice) return;
  ::setpriority(PRIO_PROCESS, 0, kBackgroundNice);
}

LargePlans::LargePlans(int threads, std::size_t at_once, std::size_t of_client, ClientUse* use)
    : of_client_(of_client), use_(use) {
  for (std::size_t i = 0; i < at_once; ++i) {
    pools_.push_back(std::make_unique<TaskPool>(threads));
    idle_.push_back(pools_.back().get());
  }
}

LargePlans::~LargePlans() {
  std::unique_lock lock(mutex_);
  all_idle_.wait(lock, [&] { return idle_.size() == pools_.size(); });
}

void LargePlans::post(const std::string& client, std::function<void()> work) {
  if (is_background(client)) work = politely(pools_.front()->threads(), std::move(work));
  const std::lock_guard lock(mutex_);
  waiting_.push(client, {client, std::move(work)});
  start_waiting();
}

/// With the lock, while a pool is idle.
bool LargePlans::may_start(const std::string& client) const {
  const auto own = running_.find(client);
  if (own != running_.end() && own->second >= of_client_) return false;
  if (!is_background(client) || pools_.size() == 1) return true;
  std::size_t of_jobs = 0;
  for (const auto& [name, count] : running_) of_jobs += is_background(name) ? count : 0;
  return of_jobs + 1 < pools_.size();
}

void LargePlans::start_waiting() {
  while (!idle_.empty()) {
    auto next = waiting_.take([this](const std::string& client) { return may_start(client); });
    if (!next) return;
    TaskPool* const pool = idle_.back();
    idle_.pop_back();
    ++running_[next->client];
    pool->post([this, pool, started = *std::move(next)] {
      const auto begin = std::chrono::steady_clock::now();
      contain("work on a large mesh", started.work);
      finished(pool, started.client, std::chrono::steady_clock::now() - begin);
    });
  }
}

void LargePlans::finished(TaskPool* pool,
                          const std::string& client,
                          std::chrono::nanoseconds use) {
  if (use_ != nullptr) use_->of(client).work_ns += use.count();
  const std::lock_guard lock(mutex_);
  waiting_.charge(client, use);
  idle_.push_back(pool);
  const auto own = running_.find(client);
  if (--own->second == 0) running_.erase(own);
  start_waiting();
  if (idle_.size() == pools_.size()) all_idle_.notify_all();
}

}  // namespace tet
