#include "server/jobs/service/job_notifier.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <absl/time/clock.h>

#include "server/ops/guard.h"

namespace tet {

namespace {

/// One look at the store, which ends sooner where something happens.
constexpr absl::Duration kNewsInterval = absl::Milliseconds(500);

bool concerns(const JobEvent& event, const std::string& space, const std::string& job) {
  return event.space == space && (job.empty() || event.job == job);
}

}  // namespace

JobNotifier::JobNotifier(JobStore& jobs)
    : jobs_(jobs), thread_([this](const std::stop_token& stopping) { run(stopping); }) {}

std::unique_ptr<JobNotifier::Subscription> JobNotifier::subscribe(const std::string& space,
                                                                  const std::string& job,
                                                                  std::function<void()> tell) {
  const std::lock_guard lock(mutex_);
  listeners_[++last_number_] = {space, job, std::move(tell)};
  changed_.notify_all();
  return std::make_unique<Subscription>(*this, last_number_);
}

void JobNotifier::leave(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  listeners_.erase(number);
}

// Everyone is told once after the revision was read from which on there will be events: what
// happened before has no other messenger.
void JobNotifier::run(const std::stop_token& stopping) {
  while (wait_for_listeners(stopping)) {
    const absl::Status told = guarded("news of jobs", [&] {
      const auto last = jobs_.revision();
      if (!last.ok()) return last.status();
      tell_all();
      read_on(*last, stopping);
      return absl::OkStatus();
    });
    if (!told.ok()) absl::SleepFor(kNewsInterval);
  }
}

bool JobNotifier::wait_for_listeners(const std::stop_token& stopping) {
  std::unique_lock lock(mutex_);
  return changed_.wait(lock, stopping, [&] { return !listeners_.empty(); }) &&
         !stopping.stop_requested();
}

/// Until nobody listens any more, or the store does not tell what happened: then all begin
/// anew.
void JobNotifier::read_on(std::int64_t revision, const std::stop_token& stopping) {
  while (!stopping.stop_requested()) {
    WatchJobs query;
    query.after_revision = revision;
    query.wait = kNewsInterval;
    const auto page = jobs_.watch(query);
    if (!page.ok()) return;
    revision = page->revision;
    if (!tell(*page)) return;
  }
}

/// False when nobody listens.
bool JobNotifier::tell(const EventPage& page) {
  std::vector<std::function<void()>> concerned;
  {
    const std::lock_guard lock(mutex_);
    if (listeners_.empty()) return false;
    for (const auto& entry : listeners_) {
      const auto& listener = entry.second;  // Clang 14 captures no part of a pair
      const bool news = std::ranges::any_of(page.events, [&](const JobEvent& event) {
        return concerns(event, listener.space, listener.job);
      });
      if (news) concerned.push_back(listener.tell);
    }
  }
  for (const auto& tell_one : concerned) tell_one();
  return true;
}

void JobNotifier::tell_all() {
  std::vector<std::function<void()>> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [number, listener] : listeners_) all.push_back(listener.tell);
  }
  for (const auto& tell_one : all) tell_one();
}

}  // namespace tet
