#include "server/jobs/results/result_ledger.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>

#include <absl/strings/numbers.h>
#include <absl/strings/str_format.h>

#include "proto/convert/status.h"
#include "server/ops/disk.h"

namespace tet {

namespace {

constexpr char kAccount[] = ".account", kWriting[] = ".writing";

/// Digits of the largest number, and the end of the line.
constexpr std::size_t kTotalBytes = 21;

// Counting millions of files takes seconds; a process that was stopped holds the account for
// ever.
constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::milliseconds kFirstPause{1}, kLongestPause{50};

absl::Status held_for_too_long() {
  return with_retry(
      absl::UnavailableError(absl::StrFormat(
          "another process has held the account of results for %d s", kPatience.count())),
      absl::Seconds(5));
}

/// A waiting lock would wait for ever.
absl::Status lock_alone(File& file) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  for (auto pause = kFirstPause;; pause = std::min(2 * pause, kLongestPause)) {
    const auto locked = file.lock(FileLock::kAlone);
    if (!locked.ok()) return locked.status();
    if (*locked) return absl::OkStatus();
    if (std::chrono::steady_clock::now() >= end) return held_for_too_long();
    std::this_thread::sleep_for(pause);
  }
}

}  // namespace

absl::StatusOr<ResultLedger::Turn> ResultLedger::take() const {
  auto file = open_file(folder_ / kAccount, O_RDWR | O_CREAT);
  if (!file.ok()) return file.status();
  if (auto locked = lock_alone(*file); !locked.ok()) return locked;
  return Turn(folder_, *std::move(file));
}

std::optional<std::uint64_t> ResultLedger::Turn::total() const {
  std::array<char, kTotalBytes> text{};
  const auto read = file_.read_at(0, text);
  std::uint64_t total = 0;
  const bool whole = read.ok() && *read == text.size() && text.back() == '\n';
  if (!whole || !absl::SimpleAtoi(std::string(text.data(), text.size() - 1), &total)) {
    return std::nullopt;
  }
  return total;
}

absl::Status ResultLedger::Turn::set(std::uint64_t total) {
  return file_.write_at(0, absl::StrFormat("%020d\n", total));
}

absl::StatusOr<bool> ResultLedger::Turn::is_quiet() {
  if (nobody_writes_) return true;
  auto file = open_file(folder_ / kWriting, O_RDWR | O_CREAT);
  if (!file.ok()) return file.status();
  const auto alone = file->lock(FileLock::kAlone);
  if (alone.ok() && *alone) nobody_writes_ = *std::move(file);
  return alone;
}

// Only who counts has that file alone, in a turn of its own: nobody waits here.
absl::StatusOr<File> ResultLedger::Turn::join_writers() {
  nobody_writes_.reset();
  auto file = open_file(folder_ / kWriting, O_RDWR | O_CREAT);
  if (!file.ok()) return file.status();
  const auto shared = file->lock(FileLock::kShared);
  if (!shared.ok()) return shared.status();
  return file;
}

}  // namespace tet
