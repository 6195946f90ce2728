#include "core/base/posix/memory_file.h"

#include <cerrno>
#include <sys/mman.h>

namespace tet {

namespace {
/// Has a memory file without the right to be run, and sealed so: of Linux 6.3, whose number
/// older headers do not have.
constexpr unsigned kNoExecSeal = 0x0008U;
}  // namespace

// A host may refuse any memory file that could be run (the sysctl vm.memfd_noexec), and kernels
// of before refuse the flag.
Descriptor make_memory_file(const char* name) noexcept {
  constexpr unsigned kFlags = MFD_CLOEXEC | MFD_ALLOW_SEALING;
  Descriptor memory(::memfd_create(name, kFlags | kNoExecSeal));
  if (memory.is_open() || errno != EINVAL) return memory;
  return Descriptor(::memfd_create(name, kFlags));
}

}  // namespace tet
