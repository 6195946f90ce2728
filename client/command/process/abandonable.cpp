#include "client/command/process/abandonable.h"

#include <array>
#include <atomic>
#include <poll.h>

namespace tet {
namespace {

std::atomic<bool> work_was_abandoned{false};

/// Milliseconds from one call of `goes_on` to the next: progress looks alive. Where the process
/// has no descriptors left, this is also how soon an end is seen.
constexpr int kTick = 50;

}  // namespace

void note_abandoned_work() noexcept { work_was_abandoned = true; }

bool has_abandoned_work() noexcept { return work_was_abandoned; }

bool wait_for_work(const WorkWatch& work, const Cancellation& interruption) {
  const int done = work.done.number(), interrupted = interruption.descriptor();
  std::array<pollfd, 2> either{{{done, POLLIN, 0}, {interrupted, POLLIN, 0}}};
  const bool ticks = work.goes_on || done < 0 || interrupted < 0;
  while (!work.is_done()) {
    if (interruption.requested()) return false;
    ::poll(either.data(), either.size(), ticks ? kTick : -1);
    if (work.goes_on) work.goes_on();
  }
  return true;
}

}  // namespace tet
