// Readings that may take a while, for readers who cannot wait long.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "server/ops/metrics.h"

namespace tet {

/// Reads anew for whoever asks, on a thread of its own; if that takes too long, because a disk
/// or a database does not answer, what was read before is given out, with
/// `tetstream_readings_old` 1. Thread-safe. The destructor waits for a reading under way.
class LatestReadings {
 public:
  static constexpr std::chrono::seconds kPatience{2};

  explicit LatestReadings(std::function<std::vector<Reading>()> read);
  ~LatestReadings();

  std::vector<Reading> get(std::chrono::milliseconds patience = kPatience);

 private:
  void work(const std::stop_token& stopping);

  const std::function<std::vector<Reading>()> read_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::uint64_t wanted_ = 0;     ///< times that readings were asked for
  std::uint64_t read_last_ = 0;  ///< the last of them that `readings_` are good for
  std::vector<Reading> readings_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace tet
