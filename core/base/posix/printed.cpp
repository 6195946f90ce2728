#include "core/base/posix/printed.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <poll.h>
#include <unistd.h>

namespace tet {
namespace {

/// Whether stdout is a pipe that nobody can read any more.
bool has_no_reader() {
  pollfd out{STDOUT_FILENO, 0, 0};
  return ::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
}

}  // namespace

int exit_code_of_printed(int code, const char* program) {
  errno = 0;
  const bool arrived = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (arrived || code != 0) return code;
  // Whoever reads the first lines alone, as `head` does, has had what it wanted.
  if (errno == EPIPE || has_no_reader()) return 128 + SIGPIPE;
  std::fprintf(stderr, "%s: what it printed cannot be written: %s\n", program,
               errno == 0 ? "some of it was lost" : std::strerror(errno));
  return 1;
}

}  // namespace tet
