// Long work of libraries that cannot be stopped, left behind when the user stops the command.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <thread>
#include <utility>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"

namespace tet {

/// Set once work was left behind: its thread still runs, and the process must end without
/// waiting for it or taking away what it uses (std::_Exit).
void note_abandoned_work() noexcept;
bool has_abandoned_work() noexcept;

/// Runs `work` on a thread of its own and returns what it does; or kCancelled, at once after
/// the interruption. `work` must own what it uses. `goes_on`, if there is one, is called all
/// the while.
template <class Result>
absl::StatusOr<Result> run_abandonable(std::function<absl::StatusOr<Result>()> work,
                                       const std::function<void()>& goes_on,
                                       const Cancellation& interruption) {
  constexpr std::chrono::milliseconds kLook{20};
  std::packaged_task<absl::StatusOr<Result>()> task(std::move(work));
  std::future<absl::StatusOr<Result>> result = task.get_future();
  std::thread thread(std::move(task));
  while (result.wait_for(kLook) != std::future_status::ready) {
    if (goes_on) goes_on();
    if (!interruption.requested()) continue;
    thread.detach();
    note_abandoned_work();
    return check_cancelled(interruption);
  }
  thread.join();
  return result.get();
}

}  // namespace tet
