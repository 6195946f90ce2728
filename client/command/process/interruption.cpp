#include "client/command/process/interruption.h"

#include <atomic>
#include <csignal>

namespace tet {
namespace {

/// Never destroyed: a signal may come while the process ends.
Cancellation& interrupted_by_user = *new Cancellation();
std::atomic<int> first_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

void on_signal(int signal) {
  int none = 0;
  first_signal.compare_exchange_strong(none, signal);
  interrupted_by_user.cancel();
}

}  // namespace

const Cancellation& watch_for_interruption() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  for (const int signal : {SIGXFSZ, SIGPIPE}) std::signal(signal, SIG_IGN);
  return interrupted_by_user;
}

const Cancellation& user_interruption() noexcept { return interrupted_by_user; }

int interrupting_signal() noexcept { return first_signal.load(); }

}  // namespace tet
