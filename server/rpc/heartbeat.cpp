#include "server/rpc/heartbeat.h"

#include <stop_token>
#include <utility>

#include "core/base/contain.h"

namespace tet {

Heartbeat::Heartbeat(std::chrono::milliseconds interval, std::function<void()> beat)
    : thread_([this, interval, beat = std::move(beat)](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (
            !stopped_.wait_for(lock, stop, interval, [&] { return stop.stop_requested(); })) {
          contain("a heartbeat", beat);
        }
      }) {}

}  // namespace tet
