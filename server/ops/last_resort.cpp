#include "server/ops/last_resort.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>
#include <unistd.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr int kForced = 3;
constexpr std::chrono::milliseconds kLastWords{200};

/// The signal that came; 0 if none has until then. A debugger, or whatever else stops threads
/// for a while, interrupts the wait and is none.
int await_signal(const sigset_t& signals, std::chrono::steady_clock::time_point end) {
  using std::chrono::nanoseconds;
  while (true) {
    const auto left = std::max(nanoseconds{0}, std::chrono::duration_cast<nanoseconds>(
                                                   end - std::chrono::steady_clock::now()));
    const auto seconds = std::chrono::floor<std::chrono::seconds>(left);
    const timespec patience{static_cast<time_t>(seconds.count()),
                            static_cast<long>((left - seconds).count())};
    const int signal = ::sigtimedwait(&signals, nullptr, &patience);
    if (signal > 0) return signal;
    if (errno != EINTR) return 0;
  }
}

}  // namespace

void end_after(std::chrono::seconds time, const sigset_t& signals) {
  std::thread([end = std::chrono::steady_clock::now() + time, signals] {
    const int signal = await_signal(signals, end);
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
