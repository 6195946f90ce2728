#include "server/http/listener_watch.h"

#include <cerrno>
#include <sys/epoll.h>
#include <utility>

namespace tet {

Accepted accepted_none(int error) noexcept {
  const bool no_room =
      error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
  return no_room ? Accepted::kNoRoom : Accepted::kNone;
}

void ListenerWatch::begin() {
  loop_.watch(listener_, EPOLLIN, [this](std::uint32_t) { accept_some(); });
}

void ListenerWatch::look_again() {
  if (!std::exchange(listening_, true)) loop_.change(listener_, EPOLLIN);
}

void ListenerWatch::accept_some() {
  for (int i = 0; i < kMostAtOnce; ++i) {
    const Accepted accepted = accept_one_();
    if (accepted == Accepted::kOne) continue;
    if (accepted == Accepted::kNone) return;
    listening_ = false;
    return loop_.change(listener_, 0);
  }
}

}  // namespace tet
