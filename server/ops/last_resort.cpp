#include "server/ops/last_resort.h"

#include <thread>
#include <unistd.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr int kForced = 3;
constexpr std::chrono::milliseconds kLastWords{200};

}  // namespace

void end_after(std::chrono::seconds time, const sigset_t& signals) {
  std::thread([time, signals] {
    const timespec patience{static_cast<time_t>(time.count()), 0};
    const int signal = ::sigtimedwait(&signals, nullptr, &patience);
    log_event(spdlog::level::err, "forced_end",
              {{"signal", signal > 0 ? signal : 0},
               {"message", signal > 0 ? "told once more" : "something does not end"}});
    flush_log(kLastWords);
    ::_exit(kForced);
  }).detach();
}

void ignore_hangups() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
}

}  // namespace tet
