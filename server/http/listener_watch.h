// A listening socket in an event loop: its connections are taken a few at a time.
#pragma once

#include <functional>
#include <utility>

#include "server/http/event_loop.h"

namespace tet {

/// What became of an attempt to take the next connection.
enum class Accepted {
  kOne,
  kNone,    ///< none waits, or what waited is gone
  kNoRoom,  ///< one waits, and this process has no descriptor or memory for it
};

/// What accept(2) that has failed with `error` means: kNone or kNoRoom.
Accepted accepted_none(int error) noexcept;

/// Takes connections as they come. As many as come at once leave the loop time for others, and
/// where there is no room for one the listener is left alone until the next tick: the event
/// that it waits would come again at once.
///
/// Used on the loop's thread, or before that runs. The loop outlives this.
class ListenerWatch {
 public:
  static constexpr int kMostAtOnce = 64;
  using AcceptOne = std::function<Accepted()>;

  ListenerWatch(EventLoop& loop, int listener, AcceptOne accept_one)
      : loop_(loop), listener_(listener), accept_one_(std::move(accept_one)) {}

  void begin();
  /// To be called at each tick.
  void look_again();
  void end() { loop_.forget(listener_); }

 private:
  void accept_some();

  EventLoop& loop_;
  const int listener_;
  const AcceptOne accept_one_;
  bool listening_ = true;
};

}  // namespace tet
