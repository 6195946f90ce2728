#include "core/base/posix/printed.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace tet {

int exit_code_of_printed(int code, const char* program) {
  errno = 0;
  const bool arrived = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (arrived || code != 0) return code;
  std::fprintf(stderr, "%s: what it printed cannot be written: %s\n", program,
               errno == 0 ? "some of it was lost" : std::strerror(errno));
  return 1;
}

}  // namespace tet
