#include "server/rpc/fair_tasks.h"

#include <optional>
#include <utility>

namespace tet {

void FairTasks::post(const std::string& client, std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push(client, std::move(task));
  }
  pool_.post([this] { run_next(); });
}

void FairTasks::run_next() {
  std::optional<std::function<void()>> task;
  {
    const std::lock_guard lock(mutex_);
    task = waiting_.take([](const std::string&) { return true; });
  }
  (*task)();
}

}  // namespace tet
