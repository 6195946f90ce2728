#include "core/base/posix/descriptor.h"

#include <cerrno>
#include <fcntl.h>

namespace tet {

Descriptor open_descriptor(const std::filesystem::path& path, int flags, mode_t mode) noexcept {
  int number = -1;
  do {
    number = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  } while (number < 0 && errno == EINTR);
  return Descriptor(number);
}

Descriptor open_descriptor_in(const Descriptor& folder,
                              const std::filesystem::path& path,
                              int flags) noexcept {
  int number = -1;
  do {
    number = ::openat(folder.number(), path.c_str(), flags | O_CLOEXEC);
  } while (number < 0 && errno == EINTR);
  return Descriptor(number);
}

}  // namespace tet
