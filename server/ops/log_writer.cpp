#include "server/ops/log_writer.h"

#include <fcntl.h>
#include <poll.h>
#include <thread>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

namespace tet {

namespace {

// Longer than writing a line takes unless something is wrong.
constexpr std::chrono::milliseconds kSoon{20};

}  // namespace

LogWriter& LogWriter::start(int descriptor, std::size_t most_bytes) {
  auto* const writer = new LogWriter(
      File(Descriptor(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0)), "the log", io_error),
      most_bytes);
  std::thread([writer] { writer->work(); }).detach();
  return *writer;
}

// A line that is on its way when the process is killed would be lost: so whoever has it written
// waits as long as that takes, but not behind others, and not for ever.
void LogWriter::write(std::string line) {
  std::unique_lock lock(mutex_);
  if (bytes_ + line.size() > most_bytes_) {
    ++dropped_;
    return;
  }
  const bool is_alone = lines_.empty() && done_ == taken_;
  const std::uint64_t number = ++taken_;
  bytes_ += line.size();
  lines_.push_back(std::move(line));
  came_.notify_one();
  if (is_alone) written_.wait_for(lock, kSoon, [&] { return done_ >= number; });
}

void LogWriter::flush(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  written_.wait_for(lock, timeout, [&] { return done_ == taken_; });
}

std::int64_t LogWriter::dropped_lines() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void LogWriter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    came_.wait(lock, [&] { return !lines_.empty(); });
    std::string text = std::move(lines_.front());
    lines_.pop_front();
    const std::size_t bytes = text.size();
    text += told_of_dropped();
    lock.unlock();
    // A descriptor that others made non-blocking is waited for all the same. What cannot be
    // written, since nobody has the other end any more, is lost.
    pollfd room{file_.descriptor().number(), POLLOUT, 0};
    ::poll(&room, 1, -1);
    file_.append(text).IgnoreError();
    lock.lock();
    bytes_ -= bytes;
    ++done_;
    written_.notify_all();
  }
}

/// A line about those that were dropped since the last; none if there were none.
std::string LogWriter::told_of_dropped() {
  const std::int64_t dropped = dropped_ - std::exchange(told_dropped_, dropped_);
  if (dropped == 0) return "";
  const std::string time =
      absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::Now(), absl::UTCTimeZone());
  return absl::StrCat("{\"time\":\"", time,
                      "\",\"level\":\"warning\",\"event\":\"log_dropped\",\"lines\":", dropped,
                      "}\n");
}

}  // namespace tet
