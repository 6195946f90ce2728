#include "server/ops/latest_readings.h"

#include <utility>

#include "core/base/contain.h"

namespace tet {

LatestReadings::LatestReadings(std::function<std::vector<Reading>()> read)
    : read_(std::move(read)),
      thread_([this](const std::stop_token& stopping) { work(stopping); }) {}

LatestReadings::~LatestReadings() { thread_.request_stop(); }

std::vector<Reading> LatestReadings::get(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const std::uint64_t mine = ++wanted_;
  changed_.notify_all();
  const bool is_new = changed_.wait_for(lock, patience, [&] { return read_last_ >= mine; });
  std::vector<Reading> readings = readings_;
  readings.push_back(gauge("tetstream_readings_old",
                           "1 while what is read of disks and databases is of before, since "
                           "they do not answer.",
                           !is_new));
  return readings;
}

void LatestReadings::work(const std::stop_token& stopping) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stopping, [&] { return read_last_ < wanted_; })) {
    const std::uint64_t good_for = wanted_;
    lock.unlock();
    std::vector<Reading> readings;
    contain("the readings for metrics", [&] { readings = read_(); });
    lock.lock();
    readings_ = std::move(readings);
    read_last_ = good_for;
    changed_.notify_all();
  }
}

}  // namespace tet
