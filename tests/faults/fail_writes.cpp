// Preloaded into a server by a test: changes to files fail as if the disk were full. Either
// from the n-th on, when the first that is a write leaves half of its bytes behind:
//   TET_FAIL_AT=n  TET_FAIL_MARK=path (made when the first change fails)
// or as long as a file is there, for paths that have one of these texts in them:
//   TET_FULL_WHILE=path  TET_FULL_AT=text:text
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <dlfcn.h>
#include <fcntl.h>
#include <sstream>
#include <string>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

using Open = int (*)(const char*, int, ...);

bool is_on_the_full_disk(const std::string& path) {
  static const char* const marker = std::getenv("TET_FULL_WHILE");
  static const char* const texts = std::getenv("TET_FULL_AT");
  if (marker == nullptr || texts == nullptr || ::access(marker, F_OK) != 0) return false;
  std::istringstream all(texts);
  for (std::string text; std::getline(all, text, ':');) {
    if (path.find(text) != std::string::npos) return true;
  }
  return false;
}

std::string path_of(int descriptor) {
  char path[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = ::readlink(link.c_str(), path, sizeof path);
  return size > 0 ? std::string(path, static_cast<std::size_t>(size)) : "";
}

/// Whether this change, which is one more, fails.
bool fails(const std::string& path, bool& first) {
  if (is_on_the_full_disk(path)) {
    errno = ENOSPC;
    return true;
  }
  static const char* const at = std::getenv("TET_FAIL_AT");
  static std::atomic<long> changes{0};
  if (at == nullptr) return false;
  const long change = ++changes, limit = std::atol(at);
  first = change == limit;
  if (change < limit) return false;
  if (first) {
    static const auto real_open = next<Open>("open");
    ::close(real_open(std::getenv("TET_FAIL_MARK"), O_WRONLY | O_CREAT, 0600));
  }
  errno = ENOSPC;
  return true;
}

bool fails(const std::string& path) {
  bool first = false;
  return fails(path, first);
}

/// On a disk: neither a log nor memory that looks like a file.
bool is_file(int descriptor) {
  struct stat info {};
  if (descriptor <= 2 || ::fstat(descriptor, &info) != 0) return false;
  return (S_ISREG(info.st_mode) || S_ISDIR(info.st_mode)) && info.st_nlink > 0;
}

/// The server's own processes have nothing to write, and may not do what this library does.
__attribute__((constructor)) void stay_in_this_process() { ::unsetenv("LD_PRELOAD"); }

}  // namespace

extern "C" {

ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t offset) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  bool first = false;
  if (!is_file(descriptor) || !fails(path_of(descriptor), first)) {
    return real(descriptor, bytes, size, offset);
  }
  if (first) real(descriptor, bytes, size / 2, offset);
  errno = ENOSPC;
  return -1;
}

ssize_t write(int descriptor, const void* bytes, size_t size) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
  return is_file(descriptor) && fails(path_of(descriptor)) ? -1 : real(descriptor, bytes, size);
}

int fdatasync(int descriptor) {
  static const auto real = next<int (*)(int)>("fdatasync");
  return is_file(descriptor) && fails(path_of(descriptor)) ? -1 : real(descriptor);
}

int ftruncate(int descriptor, off_t size) noexcept {
  static const auto real = next<int (*)(int, off_t)>("ftruncate");
  return is_file(descriptor) && fails(path_of(descriptor)) ? -1 : real(descriptor, size);
}

int rename(const char* from, const char* to) noexcept {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return fails(to) ? -1 : real(from, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
  static const auto real = next<int (*)(const char*, mode_t)>("mkdir");
  return fails(path) ? -1 : real(path, mode);
}

int open(const char* path, int flags, ...) {
  static const auto real = next<Open>("open");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return (flags & O_CREAT) != 0 && fails(path) ? -1 : real(path, flags, mode);
}

// SQLite's names for them, which are the same on a machine of 64 bits.
ssize_t pwrite64(int, const void*, size_t, off_t) __attribute__((alias("pwrite")));
int ftruncate64(int, off_t) noexcept __attribute__((alias("ftruncate")));
int open64(const char*, int, ...) __attribute__((alias("open")));

}  // extern "C"
