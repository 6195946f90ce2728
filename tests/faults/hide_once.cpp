// Preloaded into a worker by a test: a file is not there when it is opened to be read, once, as
// in a store that was not mounted at that moment and is again.
//   TET_HIDE_ONCE=path (as soon as there is a file; it is removed then)  TET_HIDE_AT=text
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

using Open = int (*)(const char*, int, ...);

/// Whoever removes the mark is the one who does not see the file.
bool is_hidden(const char* path, int flags) {
  static const char* const mark = std::getenv("TET_HIDE_ONCE");
  static const char* const text = std::getenv("TET_HIDE_AT");
  return mark != nullptr && text != nullptr && (flags & O_ACCMODE) == O_RDONLY &&
         std::strstr(path, text) != nullptr && ::unlink(mark) == 0;
}

/// The worker's own processes are not meant.
__attribute__((constructor)) void stay_in_this_process() { ::unsetenv("LD_PRELOAD"); }

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  static const auto real = reinterpret_cast<Open>(::dlsym(RTLD_NEXT, "open"));
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (!is_hidden(path, flags)) return real(path, flags, mode);
  errno = ENOENT;
  return -1;
}

int open64(const char*, int, ...) __attribute__((alias("open")));

}  // extern "C"
