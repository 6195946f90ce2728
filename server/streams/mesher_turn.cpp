#include "server/streams/mesher_turn.h"

#include <functional>
#include <utility>

namespace tet {

namespace {

/// What is not opened so much later waits for a file to be read, or takes one of the longer
/// turns of plans. These have limits of their own, and a place would be held for minutes.
constexpr std::chrono::milliseconds kOpening{300};

}  // namespace

void MesherTurn::take(Ticket place) {
  const std::lock_guard lock(mutex_);
  place_ = std::move(place);
  opened_ = false;
  idle_since_ = Clock::now();
}

void MesherTurn::opened() {
  const std::lock_guard lock(mutex_);
  opened_ = true;
  idle_since_ = Clock::now();
  if (std::exchange(lent_, false)) admission_.resume_mesh();
}

void MesherTurn::give_back() {
  Ticket last;  // given back without the lock
  const std::lock_guard lock(mutex_);
  if (std::exchange(lent_, false)) admission_.resume_mesh();
  last.swap(place_);
}

void MesherTurn::begin() {
  const std::lock_guard lock(mutex_);
  ++running_;
  if (std::exchange(lent_, false)) admission_.resume_mesh();
}

void MesherTurn::end() {
  const std::lock_guard lock(mutex_);
  if (--running_ == 0) idle_since_ = Clock::now();
}

void MesherTurn::lend_if_idle_since(Clock::time_point then) {
  std::function<void()> tell_others;
  {
    const std::lock_guard lock(mutex_);
    const auto since = opened_ ? then : then - kOpening;
    const bool idle = running_ == 0 && idle_since_ <= since;
    if (place_ == nullptr || lent_ || !idle) return;
    lent_ = true;
    // Within the lock: whoever finds it lent takes back what was given.
    tell_others = admission_.pause_mesh();
  }
  tell_others();
}

}  // namespace tet
