#include "proto/wire/transport.h"

#include <cstdlib>
#include <malloc.h>

#include <grpc/support/log.h>

namespace tet {

namespace {
constexpr std::size_t kFreeBytes = std::size_t{16} << 20;
}

// gRPC reads into blocks of 64 KiB at most, and a stream has a few megabytes of them. Whatever
// is larger is a plan's or a grid's, and goes back to the system when that does.
void keep_read_blocks() noexcept {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
}

void quieten_grpc() noexcept {
  if (std::getenv("GRPC_VERBOSITY") == nullptr) gpr_set_log_function([](gpr_log_func_args*) {});
}

// Threads' arenas keep what fragments leave free, whatever the threshold.
void give_back_free_memory() noexcept {
  if (mallinfo2().fordblks > kFreeBytes) malloc_trim(0);
}

}  // namespace tet
