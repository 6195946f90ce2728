#include "core/vdb/decoder/idle_threads.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <unistd.h>

#include <absl/status/statusor.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

namespace tet {

#ifdef TET_NO_SANDBOX  // sanitizers have threads that never sleep

absl::Status await_idle_threads() { return absl::OkStatus(); }

#else

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOwnTasks = "/proc/self/task";
constexpr std::string_view kAsleep = "S";

// Looks that find the same, one after another: one that just goes to sleep or wakes counts one
// switch more in the next.
constexpr int kSameLooks = 3;

// A thread starts in less than a millisecond, but a full machine may let it wait for its turn.
constexpr std::chrono::milliseconds kPause{1};
constexpr std::chrono::seconds kMostWaited{60};

/// How a thread is, and how often it went to sleep so far.
struct Thread {
  std::string state;     ///< a letter: S sleeps
  std::string switches;  ///< how often it gave up a processor, of its own will and not
  bool operator==(const Thread&) const = default;
};

using Threads = std::map<std::string, Thread>;

/// "State:\tS (sleeping)" is "S".
std::string value_in(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(" \t", line.find(':') + 1);
  if (begin == std::string::npos) return "";
  return line.substr(begin, line.find_first_of(" \t", begin) - begin);
}

/// One that has ended meanwhile has no state.
Thread look_at(const fs::path& task) {
  std::ifstream status(task / "status");
  Thread thread;
  for (std::string line; std::getline(status, line);) {
    if (absl::StartsWith(line, "State:")) thread.state = value_in(line);
    if (absl::StrContains(line, "ctxt_switches:")) {
      absl::StrAppend(&thread.switches, " ", value_in(line));
    }
  }
  return thread;
}

absl::StatusOr<Threads> look_at_others() {
  const std::string own = std::to_string(::gettid());
  Threads threads;
  std::error_code error;
  fs::directory_iterator task(kOwnTasks, error);
  for (; !error && task != fs::directory_iterator(); task.increment(error)) {
    const std::string number = task->path().filename().string();
    if (number != own) threads[number] = look_at(task->path());
  }
  if (!error) return threads;
  return absl::InternalError(absl::StrCat(std::string(kOwnTasks), ": ", error.message()));
}

bool all_sleep(const Threads& threads) {
  for (const auto& [number, thread] : threads) {
    if (thread.state != kAsleep) return false;
  }
  return true;
}

}  // namespace

absl::Status await_idle_threads() {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + kMostWaited;
  Threads before;
  for (int same = 0; same < kSameLooks;) {
    absl::StatusOr<Threads> now = look_at_others();
    if (!now.ok()) return now.status();
    if (now->empty()) return absl::OkStatus();
    same = !all_sleep(*now) ? 0 : *now == before ? same + 1 : 1;
    before = *std::move(now);
    if (same > 0) continue;
    if (Clock::now() > end) {
      return absl::InternalError("a thread of a library works on and on");
    }
    std::this_thread::sleep_for(kPause);
  }
  return absl::OkStatus();
}

#endif

}  // namespace tet
