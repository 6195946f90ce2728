// Tells calls that wait for jobs when something happened to them.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "server/jobs/store/job_store.h"

namespace tet {

/// One thread reads the store's events for all calls of this process, and only while there are
/// some.
///
/// Thread safety: any thread may call any member.
class JobNotifier {
 public:
  explicit JobNotifier(JobStore& jobs);

  /// What a call waits for; no more once it is destroyed, but for what is being told.
  class Subscription;

  /// Calls `tell` whenever there is an event of the job, or of any in the namespace where `job`
  /// is empty, and sometimes when there is none; on the notifier's thread, so it should not
  /// take long. Whoever reads the store after subscribing misses nothing.
  std::unique_ptr<Subscription> subscribe(const std::string& space,
                                          const std::string& job,
                                          std::function<void()> tell);

 private:
  struct Listener {
    std::string space, job;
    std::function<void()> tell;
  };

  void run(const std::stop_token& stopping);
  bool wait_for_listeners(const std::stop_token& stopping);
  void read_on(std::int64_t revision, const std::stop_token& stopping);
  bool tell(const EventPage& page);
  void tell_all();
  void leave(std::uint64_t number);

  JobStore& jobs_;
  std::mutex mutex_;  ///< guards what follows
  std::condition_variable_any changed_;
  std::uint64_t last_number_ = 0;
  std::map<std::uint64_t, Listener> listeners_;
  std::jthread thread_;
};

class JobNotifier::Subscription {
 public:
  Subscription(JobNotifier& notifier, std::uint64_t number)
      : notifier_(notifier), number_(number) {}
  ~Subscription() { notifier_.leave(number_); }
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

 private:
  JobNotifier& notifier_;
  const std::uint64_t number_;
};

}  // namespace tet
