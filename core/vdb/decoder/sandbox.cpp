#include "core/vdb/decoder/sandbox.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <absl/strings/str_cat.h>

#include "core/vdb/decoder/idle_threads.h"

namespace tet {
namespace {

absl::Status refused(const char* what, int error) {
  return absl::InternalError(
      absl::StrCat("the sandbox cannot be entered: ", what, ": ", std::strerror(error)));
}

/// No more than `value`, and than whoever started us allowed.
absl::Status limit(__rlimit_resource resource, std::uint64_t value, const char* what) {
  rlimit now{};
  if (::getrlimit(resource, &now) != 0) return refused(what, errno);
  const rlim_t most = std::min<rlim_t>(value, now.rlim_max);
  const rlimit both{most, most};
  return ::setrlimit(resource, &both) == 0 ? absl::OkStatus() : refused(what, errno);
}

/// SIGXCPU comes at `seconds`, and tells the parent why the process ended. Where both limits
/// are one, the kernel kills without a word.
absl::Status limit_processor_time(std::uint64_t seconds) {
  rlimit now{};
  if (::getrlimit(RLIMIT_CPU, &now) != 0) return refused("processor time", errno);
  const rlim_t hard = std::min<rlim_t>(seconds + 1, now.rlim_max);
  const rlimit both{std::min<rlim_t>(seconds, hard > 0 ? hard - 1 : 0), hard};
  return ::setrlimit(RLIMIT_CPU, &both) == 0 ? absl::OkStatus()
                                             : refused("processor time", errno);
}

absl::Status control(int option, unsigned long value, const char* what) {
  return ::prctl(option, value, 0UL, 0UL, 0UL) == 0 ? absl::OkStatus() : refused(what, errno);
}

#ifdef TET_NO_SANDBOX

absl::Status limit_resources(const DecodeLimits&) { return absl::OkStatus(); }
absl::Status limit_system_calls(int, int, int) { return absl::OkStatus(); }

#else

/// Address space that the process has now; 0 if the system does not say.
std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

absl::Status limit_resources(const DecodeLimits& limits) {
  absl::Status status =
      limit(RLIMIT_AS, address_space() + limits.working_bytes, "address space");
  if (status.ok()) status = limit(RLIMIT_FSIZE, limits.result_bytes, "file size");
  if (status.ok()) status = limit(RLIMIT_NPROC, 0, "processes");
  if (status.ok()) status = limit(RLIMIT_MEMLOCK, 0, "locked memory");
  if (status.ok()) status = limit(RLIMIT_NOFILE, 0, "files");
  return status;
}

/// The system calls that remain, each with what its arguments may be. The first error is kept.
class Allowance {
 public:
  Allowance() : filter_(::seccomp_init(SCMP_ACT_KILL_PROCESS), ::seccomp_release) {
    if (filter_ == nullptr) error_ = ENOMEM;
  }

  template <class... Conditions>
  void add(int call, Conditions... conditions) {
    if (error_ != 0) return;
    error_ = -::seccomp_rule_add(filter_.get(), SCMP_ACT_ALLOW, call, sizeof...(conditions),
                                 conditions...);
  }

  /// On every thread of the process: libraries start some before main.
  absl::Status impose() {
    if (error_ == 0) {
      error_ = -::seccomp_attr_set(filter_.get(), SCMP_FLTATR_CTL_TSYNC, 1);
    }
    if (error_ == 0) error_ = -::seccomp_load(filter_.get());
    return error_ == 0 ? absl::OkStatus() : refused("system calls", error_);
  }

 private:
  std::unique_ptr<void, void (*)(scmp_filter_ctx)> filter_;
  int error_ = 0;
};

scmp_arg_cmp argument_is(unsigned index, std::uint64_t value) {
  return scmp_arg_cmp{index, SCMP_CMP_EQ, value, 0};
}

scmp_arg_cmp argument_is(unsigned index, int descriptor) {
  return argument_is(index, static_cast<std::uint64_t>(descriptor));
}

/// Matches an argument that has exactly the bits of `value` set among those in `mask`.
scmp_arg_cmp argument_has(unsigned index, std::uint64_t mask, std::uint64_t value) {
  return scmp_arg_cmp{index, SCMP_CMP_MASKED_EQ, mask, value};
}

absl::Status limit_system_calls(int socket, int file, int result) {
  Allowance allowed;
  allowed.add(SCMP_SYS(pread64), argument_is(0, file));
  allowed.add(SCMP_SYS(write), argument_is(0, result));
  allowed.add(SCMP_SYS(fcntl), argument_is(0, result), argument_is(1, F_ADD_SEALS));
  allowed.add(SCMP_SYS(sendto), argument_is(0, socket));
  // Memory, but none to execute and none that is a file's.
  allowed.add(SCMP_SYS(brk));
  allowed.add(SCMP_SYS(mmap), argument_has(2, PROT_EXEC, 0),
              argument_has(3, MAP_ANONYMOUS, MAP_ANONYMOUS));
  allowed.add(SCMP_SYS(munmap));
  allowed.add(SCMP_SYS(mremap));
  allowed.add(SCMP_SYS(madvise));
  // Locks and clocks of the libraries, and of the threads that these may have: they sleep in a
  // futex, and fall asleep again there when whoever stopped the process lets it go on.
  allowed.add(SCMP_SYS(futex));
  allowed.add(SCMP_SYS(restart_syscall));
  allowed.add(SCMP_SYS(sched_yield));
  allowed.add(SCMP_SYS(clock_gettime));
  allowed.add(SCMP_SYS(exit_group));
  return allowed.impose();
}

#endif

/// Where memory is short the kernel ends us before anything else, as one file's reading is lost
/// with us and not a server's calls. Raising it takes no right; where there is no /proc, or it
/// cannot be written, whoever takes most memory goes first.
void offer_ourselves_where_memory_is_short() {
  constexpr int kFirstOfAll = 1000;
  std::ofstream("/proc/self/oom_score_adj") << kFirstOfAll;
}

}  // namespace

absl::Status enter_custody() {
  offer_ourselves_where_memory_is_short();  // later we may not look into ourselves either
  absl::Status status = control(PR_SET_PDEATHSIG, SIGKILL, "end with the parent");
  if (status.ok()) status = control(PR_SET_NO_NEW_PRIVS, 1, "no new privileges");
  if (status.ok()) status = control(PR_SET_DUMPABLE, 0, "not to be looked into");
  if (status.ok()) status = limit(RLIMIT_CORE, 0, "core dump");
  return status;
}

absl::Status enter_sandbox(const DecodeLimits& limits, int socket, int file, int result) {
  // The filter would kill one that is still starting, and us with it.
  absl::Status status = await_idle_threads();
  if (status.ok()) status = limit_processor_time(limits.cpu_seconds);
  if (status.ok()) status = limit_resources(limits);
  if (status.ok()) status = limit_system_calls(socket, file, result);
  return status;
}

}  // namespace tet
