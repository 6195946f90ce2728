#include "core/base/on_cancel.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <poll.h>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/contain.h"
#include "core/base/posix/wake_event.h"

namespace tet {
namespace {

using Clock = Cancellation::Clock;

/// How long poll(2) waits at most: the clock that deadlines are on may be set meanwhile.
constexpr std::chrono::milliseconds kLongestPoll{60'000};
/// How long it waits where the process has no descriptors left to be woken by.
constexpr std::chrono::milliseconds kUnwakeablePoll{25};

/// The thread that waits for all cancellations that somebody wants to hear of. It is there from
/// the first of them to the end of the process.
class CancelWatch {
 public:
  static CancelWatch& of_process() {
    // Never destroyed: its thread uses it to the last.
    static CancelWatch* const watch = new CancelWatch();
    return *watch;
  }

  std::uint64_t add(const Cancellation& cancellation, std::function<void()> action) {
    const std::lock_guard lock(mutex_);
    const int descriptor = cancellation.descriptor();
    entries_.push_back({++last_, &cancellation, descriptor, std::move(action)});
    changed_.set();
    return last_;
  }

  void remove(std::uint64_t number) {
    std::unique_lock lock(mutex_);
    std::erase_if(entries_, [&](const Entry& entry) { return entry.number == number; });
    if (std::this_thread::get_id() == thread_) return;
    called_.wait(lock, [&] { return running_ != number; });
  }

 private:
  struct Entry {
    std::uint64_t number = 0;
    const Cancellation* cancellation = nullptr;
    int descriptor = -1;
    std::function<void()> action;
  };

  CancelWatch() {
    // Signals are for the threads of whoever runs this process.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread thread([this] { run(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    const std::lock_guard lock(mutex_);
    thread_ = thread.get_id();
    thread.detach();
  }

  [[noreturn]] void run() {
    std::vector<pollfd> polled;
    while (true) {
      const std::chrono::milliseconds time = prepare(polled);
      ::poll(polled.data(), polled.size(), static_cast<int>(time.count()));
      while (call_one()) {
      }
    }
  }

  /// What to wait for, and how long.
  std::chrono::milliseconds prepare(std::vector<pollfd>& polled) {
    const std::lock_guard lock(mutex_);
    changed_.reset();
    polled.assign(1, {changed_.number(), POLLIN, 0});
    std::chrono::milliseconds time = changed_.number() < 0 ? kUnwakeablePoll : kLongestPoll;
    const Clock::time_point now = Clock::now();
    for (const Entry& entry : entries_) {
      polled.push_back({entry.descriptor, POLLIN, 0});
      if (entry.descriptor < 0) time = std::min(time, kUnwakeablePoll);
      const Clock::time_point deadline = entry.cancellation->deadline();
      if (deadline >= now + time) continue;
      time = std::max(std::chrono::ceil<std::chrono::milliseconds>(deadline - now),
                      std::chrono::milliseconds(0));
    }
    return time;
  }

  /// Calls one action that is due, without the lock. False where none is.
  bool call_one() {
    std::function<void()> action;
    {
      const std::lock_guard lock(mutex_);
      const auto due = std::find_if(entries_.begin(), entries_.end(), [](const Entry& entry) {
        return entry.cancellation->requested();
      });
      if (due == entries_.end()) return false;
      running_ = due->number;
      action = std::move(due->action);
      entries_.erase(due);
    }
    contain("a cancellation's action", action);
    action = nullptr;  // what it holds goes before the destructor's wait ends
    const std::lock_guard lock(mutex_);
    running_ = 0;
    called_.notify_all();
    return true;
  }

  std::mutex mutex_;
  std::condition_variable called_;
  WakeEvent changed_;
  std::vector<Entry> entries_;
  std::uint64_t last_ = 0;     ///< number of the latest entry, from 1 on
  std::uint64_t running_ = 0;  ///< number of the entry whose action runs
  std::thread::id thread_;
};

}  // namespace

OnCancel::OnCancel(const Cancellation& cancellation, std::function<void()> action)
    : entry_(CancelWatch::of_process().add(cancellation, std::move(action))) {}

OnCancel::~OnCancel() { CancelWatch::of_process().remove(entry_); }

}  // namespace tet
