#include "server/rpc/fair_tasks.h"

#include <chrono>
#include <optional>
#include <utility>

#include "core/base/contain.h"

namespace tet {

void FairTasks::post(const std::string& client, std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push(client, {client, std::move(task)});
  }
  pool_.post([this] { run_next(); });
}

void FairTasks::run_next() {
  std::optional<Task> task;
  {
    const std::lock_guard lock(mutex_);
    task = waiting_.take([](const std::string&) { return true; });
  }
  const auto begin = std::chrono::steady_clock::now();
  contain("a client's task", task->work);
  const auto use = std::chrono::steady_clock::now() - begin;
  if (use_ != nullptr) use_->of(task->client).work_ns += use.count();
  task->work = nullptr;  // what it holds goes without the lock
  const std::lock_guard lock(mutex_);
  waiting_.charge(task->client, use);
}

}  // namespace tet
