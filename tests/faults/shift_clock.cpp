// A clock that is wrong: LD_PRELOAD of this, with TET_CLOCK_AHEAD_SECONDS, moves what a program
// takes for the time of day. Monotonic clocks, and the times that the kernel gives to files,
// stay. With TET_CLOCK_AHEAD_FILE it is set while the program runs: the file's eight bytes are
// the seconds, and a change of them shows at once.
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <unistd.h>

namespace {

/// The file's seconds; null where none is named, or it cannot be read.
const volatile std::int64_t* ahead_in_file() {
  const char* const path = std::getenv("TET_CLOCK_AHEAD_FILE");
  const int file = path == nullptr ? -1 : ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return nullptr;
  void* const mapped = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
  ::close(file);
  return mapped == MAP_FAILED ? nullptr : static_cast<const volatile std::int64_t*>(mapped);
}

time_t ahead_seconds() {
  static const volatile std::int64_t* const in_file = ahead_in_file();
  if (in_file != nullptr) return static_cast<time_t>(*in_file);
  static const time_t ahead = [] {
    const char* const text = std::getenv("TET_CLOCK_AHEAD_SECONDS");
    return text == nullptr ? time_t{0} : static_cast<time_t>(std::atoll(text));
  }();
  return ahead;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  using Real = int (*)(clockid_t, timespec*);
  static const auto real = reinterpret_cast<Real>(dlsym(RTLD_NEXT, "clock_gettime"));
  const int result = real(clock, time);
  const bool of_day = clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE;
  if (result == 0 && of_day) time->tv_sec += ahead_seconds();
  return result;
}

extern "C" int gettimeofday(timeval* time, void* /*zone*/) noexcept {
  timespec now{};
  const int result = clock_gettime(CLOCK_REALTIME, &now);
  time->tv_sec = now.tv_sec;
  time->tv_usec = now.tv_nsec / 1000;
  return result;
}

extern "C" time_t time(time_t* out) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (out != nullptr) *out = now.tv_sec;
  return now.tv_sec;
}
