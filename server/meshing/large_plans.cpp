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

constexpr auto kAnyone = [](const std::string&) { return true; };

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

LargePlans::LargePlans(int threads, std::size_t at_once) {
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
  waiting_.push(client, std::move(work));
  start_waiting();
}

void LargePlans::start_waiting() {
  while (!idle_.empty()) {
    auto work = waiting_.take(kAnyone);
    if (!work) return;
    TaskPool* const pool = idle_.back();
    idle_.pop_back();
    pool->post([this, pool, work = *std::move(work)] {
      contain("work on a large mesh", work);
      finished(pool);
    });
  }
}

void LargePlans::finished(TaskPool* pool) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(pool);
  start_waiting();
  if (idle_.size() == pools_.size()) all_idle_.notify_all();
}

}  // namespace tet
