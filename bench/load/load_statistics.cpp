#include "bench/load/load_statistics.h"

#include <sys/resource.h>
#include <utility>

namespace tet::load {

namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

double cpu_seconds_of_process() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

}  // namespace

LoadStatistics::LoadStatistics(std::size_t steps, std::size_t entries)
    : steps_(steps), entries_(entries) {}

template <class Change>
void LoadStatistics::change(const LoadRequest& request, const Change& change) {
  const std::lock_guard lock(mutex_);
  change(recent_);
  if (!request.measured) return;
  change(total_);
  change(steps_[request.step]);
  change(entries_[request.entry]);
}

void LoadStatistics::offered(const LoadRequest& request) {
  change(request, [](Tally& tally) { ++tally.offered; });
}

void LoadStatistics::sent(const LoadRequest& request, TimePoint when, bool queued) {
  change(request, [&](Tally& tally) {
    if (queued) {
      ++tally.queued;
    } else {
      tally.lateness.add(when - request.intended);
    }
  });
}

void LoadStatistics::dropped(const LoadRequest& request) {
  change(request, [](Tally& tally) { ++tally.dropped; });
}

void LoadStatistics::done(const LoadRequest& request, const Outcome& outcome) {
  change(request, [&](Tally& tally) { tally.add_done(request, outcome); });
}

void LoadStatistics::failed(const LoadRequest& request, const absl::Status& status) {
  change(request, [&](Tally& tally) { tally.add_failed(status); });
}

void LoadStatistics::unfinished(const LoadRequest& request, const Outcome& outcome) {
  change(request, [&](Tally& tally) { tally.add_unfinished(request, outcome); });
}

LoadStatistics::Mark LoadStatistics::mark(const Traffic& traffic) {
  return {Clock::now(), traffic, cpu_seconds_of_process()};
}

void LoadStatistics::begin_window(const Traffic& traffic) {
  const std::lock_guard lock(mutex_);
  begin_ = mark(traffic);
}

void LoadStatistics::end_window(const Traffic& traffic) {
  const std::lock_guard lock(mutex_);
  end_ = mark(traffic);
}

Window LoadStatistics::window() const {
  const std::lock_guard lock(mutex_);
  if (!begin_ || !end_) return {};
  return {
      to_seconds(end_->when - begin_->when),
      {end_->traffic.tets - begin_->traffic.tets, end_->traffic.bytes - begin_->traffic.bytes},
      end_->cpu_seconds - begin_->cpu_seconds};
}

Tally LoadStatistics::total() const {
  const std::lock_guard lock(mutex_);
  return total_;
}

Tally LoadStatistics::of_step(std::size_t step) const {
  const std::lock_guard lock(mutex_);
  return steps_[step];
}

Tally LoadStatistics::of_entry(std::size_t entry) const {
  const std::lock_guard lock(mutex_);
  return entries_[entry];
}

Tally LoadStatistics::take_recent() {
  const std::lock_guard lock(mutex_);
  return std::exchange(recent_, {});
}

}  // namespace tet::load
