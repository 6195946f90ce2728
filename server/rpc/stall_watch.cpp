#include "server/rpc/stall_watch.h"

#include <utility>

namespace tet {

void StallWatch::add(std::weak_ptr<Stallable> call) {
  const std::lock_guard lock(mutex_);
  calls_.push_back(std::move(call));
}

// A call that gives up may end here and now: not under the lock.
void StallWatch::check(Stallable::Clock::time_point now, std::chrono::seconds limit) {
  for (const std::shared_ptr<Stallable>& call : calls()) {
    call->pass_time(now);
    const auto wait = call->wait(limit);
    if (!wait || now - wait->since < wait->most) continue;
    call->give_up(std::chrono::duration_cast<std::chrono::seconds>(now - wait->since));
  }
}

/// Returns the calls that still exist, and forgets the others.
std::vector<std::shared_ptr<Stallable>> StallWatch::calls() {
  std::vector<std::shared_ptr<Stallable>> there;
  const std::lock_guard lock(mutex_);
  std::erase_if(calls_, [&](const std::weak_ptr<Stallable>& call) {
    std::shared_ptr<Stallable> held = call.lock();
    if (held == nullptr) return true;
    there.push_back(std::move(held));
    return false;
  });
  return there;
}

}  // namespace tet
