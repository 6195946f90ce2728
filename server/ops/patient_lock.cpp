#include "server/ops/patient_lock.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include <absl/strings/str_cat.h>
#include <absl/time/time.h>

#include "proto/convert/status.h"

namespace tet {

namespace {

// Counting millions of files takes seconds.
constexpr std::chrono::seconds kLongestHold{60};
constexpr std::chrono::milliseconds kFirstPause{1}, kLongestPause{50};

absl::Status held_for_too_long(std::string_view what) {
  return with_retry(
      absl::UnavailableError(absl::StrCat("another process has held ", std::string(what),
                                          " for ", kLongestHold.count(), " s")),
      absl::Seconds(5));
}

}  // namespace

absl::Status lock_patiently(File& file, std::string_view what) {
  const auto end = std::chrono::steady_clock::now() + kLongestHold;
  for (auto pause = kFirstPause;; pause = std::min(2 * pause, kLongestPause)) {
    const auto locked = file.lock(FileLock::kAlone);
    if (!locked.ok()) return locked.status();
    if (*locked) return absl::OkStatus();
    if (std::chrono::steady_clock::now() >= end) return held_for_too_long(what);
    std::this_thread::sleep_for(pause);
  }
}

}  // namespace tet
