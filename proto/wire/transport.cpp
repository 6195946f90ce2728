#include "proto/wire/transport.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <malloc.h>

#include <grpc/grpc.h>
#include <grpc/support/log.h>

namespace tet {

namespace {
using Clock = std::chrono::steady_clock;

constexpr std::size_t kFreeBytes = std::size_t{16} << 20;
constexpr std::chrono::seconds kBetween{1};
}  // namespace

// gRPC reads into blocks of 64 KiB at most, and a stream has a few megabytes of them. Whatever
// is larger is a plan's or a grid's, and goes back to the system when that does.
void keep_read_blocks() noexcept {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
}

void quieten_grpc() noexcept {
  if (std::getenv("GRPC_VERBOSITY") == nullptr) gpr_set_log_function([](gpr_log_func_args*) {});
}

void keep_grpc() noexcept {
  [[maybe_unused]] static const bool kept = [] {
    grpc_init();  // never given back
    return true;
  }();
}

// Threads' arenas keep what fragments leave free, whatever the threshold. Plans that follow
// each other take again what those before them left: having it back for each of them took as
// long as half of making it.
void give_back_free_memory() noexcept {
  static std::atomic<Clock::duration> next{Clock::duration::min()};
  const Clock::duration now = Clock::now().time_since_epoch();
  Clock::duration due = next.load();
  if (now < due || mallinfo2().fordblks <= kFreeBytes) return;
  if (next.compare_exchange_strong(due, now + kBetween)) malloc_trim(0);
}

}  // namespace tet
