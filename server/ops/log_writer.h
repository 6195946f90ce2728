// Log lines on their way out, which nobody waits for.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <utility>

#include "core/base/posix/file.h"

namespace tet {

/// Writes lines to a descriptor from a thread of its own. Whoever reads them may have stopped
/// to, or the disk under them may hang: lines then wait up to a limit, and what comes beyond it
/// is dropped and counted; a line says how many were.
///
/// Thread-safe. It is never destroyed: its thread may be stuck for as long as the process
/// lives.
class LogWriter {
 public:
  /// Begins to write to what `descriptor` leads to; at most so many bytes wait.
  static LogWriter& start(int descriptor, std::size_t most_bytes);

  /// Takes a line, with its end. Returns once it is written, or soon: at once where others are
  /// still to be.
  void write(std::string line);
  /// Returns once all lines are written, or at the timeout.
  void flush(std::chrono::milliseconds timeout);
  std::int64_t dropped_lines() const;

 private:
  LogWriter(File file, std::size_t most_bytes)
      : file_(std::move(file)), most_bytes_(most_bytes) {}
  void work();
  std::string told_of_dropped();

  File file_;  ///< of the thread
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable came_, written_;
  std::deque<std::string> lines_;
  std::size_t bytes_ = 0;    ///< of lines that are not written
  std::uint64_t taken_ = 0;  ///< lines so far
  std::uint64_t done_ = 0;   ///< of them that are written, or were lost in it
  std::int64_t dropped_ = 0, told_dropped_ = 0;
};

}  // namespace tet
