#include "server/jobs/results/result_ledger.h"

#include <array>
#include <string>

#include <absl/strings/numbers.h>
#include <absl/strings/str_format.h>

#include "server/ops/disk.h"
#include "server/ops/patient_lock.h"

namespace tet {

namespace {

constexpr char kAccount[] = ".account", kWriting[] = ".writing";

/// Digits of the largest number, and the end of the line.
constexpr std::size_t kTotalBytes = 21;

}  // namespace

absl::StatusOr<ResultLedger::Turn> ResultLedger::take() const {
  auto file = open_file(folder_ / kAccount, O_RDWR | O_CREAT);
  if (!file.ok()) return file.status();
  if (auto locked = lock_patiently(*file, "the account of results"); !locked.ok())
    return locked;
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
