#include "proto/wire/transport.h"

#include <malloc.h>

namespace tet {

// gRPC reads into blocks of up to 4 MiB; whatever is larger is a plan's or a grid's, and goes
// back to the system when that does.
void keep_read_blocks() noexcept {
  mallopt(M_MMAP_THRESHOLD, 8 << 20);
  mallopt(M_TRIM_THRESHOLD, 32 << 20);
}

}  // namespace tet
