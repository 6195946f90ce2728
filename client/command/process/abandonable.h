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
#include "core/base/posix/wake_event.h"

namespace tet {

/// Set once work was left behind: its thread still runs, and the process must end without
/// waiting for it or taking away what it uses (std::_Exit).
void note_abandoned_work() noexcept;
bool has_abandoned_work() noexcept;

/// Work under way: what tells that it is done, and what is called until then, if anything.
struct WorkWatch {
  const WakeEvent& done;
  std::function<bool()> is_done;
  const std::function<void()>& goes_on;
};

/// Waits until the work is done. False when the interruption, which has no deadline, came
/// before.
bool wait_for_work(const WorkWatch& work, const Cancellation& interruption);

/// Runs `work` on a thread of its own and returns what it does; or kCancelled, at once after
/// the interruption. `work` must own what it uses. `goes_on`, if there is one, is called all
/// the while.
template <class Result>
absl::StatusOr<Result> run_abandonable(std::function<absl::StatusOr<Result>()> work,
                                       const std::function<void()>& goes_on,
                                       const Cancellation& interruption) {
  const auto done = std::make_shared<WakeEvent>();
  std::packaged_task<absl::StatusOr<Result>()> task(std::move(work));
  std::future<absl::StatusOr<Result>> result = task.get_future();
  std::thread thread([task = std::move(task), done]() mutable {
    task();
    done->set();
  });
  const auto is_done = [&] {
    return result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  if (!wait_for_work({*done, is_done, goes_on}, interruption)) {
    thread.detach();
    note_abandoned_work();
    return check_cancelled(interruption);
  }
  thread.join();
  return result.get();
}

}  // namespace tet
