#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <sys/resource.h>
#include <thread>
#include <utility>

#ifndef TET_STD_THREADS
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

#include "core/base/contain.h"
#include "core/base/own_threads.h"

namespace tet {
namespace {

int thread_count(int requested) {
  if (requested > 0) return requested;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// How many threads the loops of this one make for themselves; 0: they are the pool's matter.
thread_local int t_own_threads = 0;

class FirstError {
 public:
  template <class Body>
  void guard(const Body& body) noexcept {
    try {
      body();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr error_;
};

/// A loop within a loop stays in its thread.
void own_ranges(std::size_t count, std::size_t grain, const internal::RangeBody& body) {
  const std::size_t threads = static_cast<std::size_t>(std::max(1, t_own_threads));
  const std::size_t step = std::max(grain, count / (threads * 8) + 1);
  std::atomic<std::size_t> next{0};
  FirstError error;
  const auto drain = [&] {
    const int outer = std::exchange(t_own_threads, 1);
    error.guard([&] {
      for (std::size_t begin = next.fetch_add(step); begin < count;
           begin = next.fetch_add(step)) {
        body(begin, std::min(count, begin + step));
      }
    });
    t_own_threads = outer;
  };
  std::vector<std::thread> helpers;
  for (std::size_t i = 1; i < threads && i * step < count; ++i) helpers.emplace_back(drain);
  drain();
  for (std::thread& helper : helpers) helper.join();
  error.rethrow();
}

}  // namespace

void run_with_own_threads(int threads, const std::function<void()>& work) {
  struct Restore {
    int outer;
    ~Restore() { t_own_threads = outer; }
  };
  const Restore restore{std::exchange(t_own_threads, thread_count(threads))};
  work();
}

#ifndef TET_STD_THREADS

namespace {

constexpr int kMaxThreads = 256;

/// By default oneTBB makes one worker fewer than there are cores, for a caller that works too;
/// but whoever posts does not. The smallest limit alive counts for the whole process, so there
/// is one: arenas, not this, bound how many threads a pool takes.
void allow_a_worker_for_every_thread() {
  static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                         kMaxThreads + 1);
}

/// Arenas whose pools are gone, for pools of as many threads. A thread that leaves an arena
/// that ended looks around for a while before it sleeps, and meanwhile the next arena gets
/// others: a loop of short calls, each with a pool of its own, ended with all 256 threads
/// looking around at once. One that stays in its arena takes the next call's work.
class IdleArenas {
 public:
  static IdleArenas& instance() {
    static auto* const arenas = new IdleArenas;  // outlives every static pool
    return *arenas;
  }

  std::unique_ptr<tbb::task_arena> take(int threads) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(idle_, threads, &Idle::threads);
    if (found == idle_.end()) {
      return std::make_unique<tbb::task_arena>(threads, /*reserved_for_masters=*/0);
    }
    std::unique_ptr<tbb::task_arena> arena = std::move(found->arena);
    idle_.erase(found);
    return arena;
  }

  /// Nothing waits in it any more.
  void give_back(int threads, std::unique_ptr<tbb::task_arena> arena) {
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kMostIdle) idle_.push_back({threads, std::move(arena)});
  }

  void clear() {
    const std::lock_guard lock(mutex_);
    idle_.clear();
  }

 private:
  static constexpr std::size_t kMostIdle = 16;
  struct Idle {
    int threads;
    std::unique_ptr<tbb::task_arena> arena;
  };

  std::mutex mutex_;
  std::vector<Idle> idle_;
};

/// On Linux the calling thread's own.
int nice_of_this_thread() { return ::getpriority(PRIO_PROCESS, 0); }

/// A thread that does small things for threads of a lower priority, one at a time.
class Deputy {
 public:
  static Deputy& instance() {
    static auto* const deputy = new Deputy;  // outlives whoever posts
    return *deputy;
  }

  void begin() {
    const std::lock_guard lock(mutex_);
    if (thread_.joinable()) return;
    nice_ = nice_of_this_thread();
    thread_ = std::jthread([this](const std::stop_token& stopping) { serve(stopping); });
  }

  /// Once nobody posts any more.
  void end() {
    nice_ = kNobody;
    thread_ = {};
  }

  void call(const std::function<void()>& work) {
    const int most = nice_;
    if (most == kNobody || nice_of_this_thread() <= most) return work();
    Call own{&work};
    std::unique_lock lock(mutex_);
    calls_.push_back(&own);
    changed_.notify_all();
    changed_.wait(lock, [&] { return own.done; });
    if (own.error) std::rethrow_exception(own.error);
  }

 private:
  static constexpr int kNobody = std::numeric_limits<int>::max();

  struct Call {
    const std::function<void()>* work;
    bool done = false;
    std::exception_ptr error = nullptr;
  };

  void serve(const std::stop_token& stopping) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stopping, [&] { return !calls_.empty(); })) {
      Call& next = *calls_.front();
      calls_.pop_front();
      lock.unlock();
      try {
        (*next.work)();
      } catch (...) {
        next.error = std::current_exception();
      }
      lock.lock();
      next.done = true;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Call*> calls_;
  std::atomic<int> nice_{kNobody};  // what callers have at most that need no deputy
  std::jthread thread_;
};

}  // namespace

void keep_priority_of_pools() { Deputy::instance().begin(); }

struct TaskPool::Impl {
  explicit Impl(int wanted) : threads(std::min(wanted, kMaxThreads)) {
    allow_a_worker_for_every_thread();
    arena = IdleArenas::instance().take(threads);
  }
  ~Impl() { IdleArenas::instance().give_back(threads, std::move(arena)); }

  const int threads;
  std::unique_ptr<tbb::task_arena> arena;
  std::mutex mutex;
  std::condition_variable idle;
  std::size_t posted = 0;
};

TaskPool::TaskPool(int threads) : impl_(std::make_unique<Impl>(thread_count(threads))) {}

TaskPool::~TaskPool() {
  std::unique_lock lock(impl_->mutex);
  impl_->idle.wait(lock, [&] { return impl_->posted == 0; });
}

int TaskPool::threads() const noexcept { return impl_->threads; }

void TaskPool::run(const std::function<void()>& work) { impl_->arena->execute(work); }

void TaskPool::post(std::function<void()> work) {
  {
    const std::lock_guard lock(impl_->mutex);
    ++impl_->posted;
  }
  const auto run = [impl = impl_.get(),
                    owned = std::make_shared<std::function<void()>>(std::move(work))] {
    contain("a posted task", *owned);  // oneTBB would drop it, and what is below with it
    *owned = nullptr;  // what it holds is released before the destructor may go on
    const std::lock_guard lock(impl->mutex);
    if (--impl->posted == 0) impl->idle.notify_all();
  };
  Deputy::instance().call([&] { impl_->arena->enqueue(run); });
}

struct WorkerThreads::Impl {
  tbb::task_scheduler_handle scheduler{tbb::attach{}};
};

WorkerThreads::WorkerThreads() : impl_(std::make_unique<Impl>()) {}
WorkerThreads::~WorkerThreads() {
  Deputy::instance().end();
  IdleArenas::instance().clear();
  tbb::finalize(impl_->scheduler, std::nothrow);
}

void stay_in_one_thread() {
  static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
}

namespace internal {

void parallel_ranges(std::size_t count, std::size_t grain, const RangeBody& body) {
  if (count == 0) return;
  if (t_own_threads > 0) return own_ranges(count, grain, body);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

}  // namespace internal

#else  // This keeps the contract on std::thread: Debian's oneTBB is opaque to ThreadSanitizer.

struct TaskPool::Impl {
  explicit Impl(int threads) {
    for (int i = 0; i < threads; ++i) {
      workers.emplace_back([this, threads] {
        t_own_threads = threads;
        work();
      });
    }
  }

  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      closing = true;
    }
    wake.notify_all();
    for (std::thread& worker : workers) worker.join();
  }

  void work() {
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [&] { return closing || !queue.empty(); });
      if (queue.empty()) return;
      std::function<void()> task = std::move(queue.front());
      queue.pop_front();
      lock.unlock();
      contain("a posted task", task);
      task = nullptr;
      lock.lock();
    }
  }

  std::mutex mutex;
  std::condition_variable wake;
  std::deque<std::function<void()>> queue;
  bool closing = false;
  std::vector<std::thread> workers;
};

TaskPool::TaskPool(int threads) : impl_(std::make_unique<Impl>(thread_count(threads))) {}
TaskPool::~TaskPool() = default;
int TaskPool::threads() const noexcept { return static_cast<int>(impl_->workers.size()); }

void TaskPool::run(const std::function<void()>& work) { run_with_own_threads(threads(), work); }

void TaskPool::post(std::function<void()> work) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->queue.push_back(std::move(work));
  }
  impl_->wake.notify_one();
}

struct WorkerThreads::Impl {};  // pools and loops wait for theirs
WorkerThreads::WorkerThreads() = default;
WorkerThreads::~WorkerThreads() = default;

void stay_in_one_thread() {}      // only pools make threads
void keep_priority_of_pools() {}  // whoever makes a pool makes its threads

namespace internal {

void parallel_ranges(std::size_t count, std::size_t grain, const RangeBody& body) {
  own_ranges(count, grain, body);
}

}  // namespace internal

#endif

}  // namespace tet
