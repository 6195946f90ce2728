#include "core/base/posix/wake_event.h"

#include <sys/eventfd.h>

namespace tet {

WakeEvent::WakeEvent() noexcept : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

// It can only fail when the event has been set some 2^64 times, and then it is set.
void WakeEvent::set() noexcept { ::eventfd_write(event_.number(), 1); }

void WakeEvent::reset() noexcept {
  eventfd_t times = 0;
  ::eventfd_read(event_.number(), &times);
}

}  // namespace tet
