// Parallel by index: the only place that knows oneTBB (std::thread under ThreadSanitizer).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace tet {

/// Threads that meshing work runs on; never the threads of a network library.
///
/// Thread safety: every member may be called from any thread. The destructor waits for all that
/// was posted.
class TaskPool {
 public:
  /// `threads` <= 0 takes every core.
  explicit TaskPool(int threads = 0);
  ~TaskPool();
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  int threads() const noexcept;

  /// Runs `work` on this pool and waits for it; parallel loops inside use the pool's threads.
  void run(const std::function<void()>& work);

  /// Runs `work` some time later, first come, first served, and does not wait.
  void post(std::function<void()> work);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For `main`, around all that makes a TaskPool or runs a loop: when it goes, it waits until
/// the threads that did the work are gone. Else they end while the process exits, and what they
/// hold of other libraries (OpenSSL's, for one) is freed twice: a crash in place of an exit
/// code. A thread that is not the pool's and still lives after a loop keeps them alive.
class WorkerThreads {
 public:
  WorkerThreads();
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// From now on this process makes no threads of its own: every loop runs in its caller's. For
/// programs that are one thread by design, before they have a TaskPool; cannot be undone.
void stay_in_one_thread();

/// For whoever makes threads that give way to others and post to pools, before it does. The
/// pools' threads are made when there is work for them, have the priority of whoever posts it,
/// and serve everybody for as long as the process lives; so from now on a thread of a lower
/// priority than the first caller's posts by one of that caller's.
void keep_priority_of_pools();

namespace internal {
using RangeBody = std::function<void(std::size_t begin, std::size_t end)>;
void parallel_ranges(std::size_t count, std::size_t grain, const RangeBody& body);
}  // namespace internal

/// Calls `body(i)` once for each i in [0, count), in any order and on any of the pool's
/// threads.
template <class Body>
void for_each_index(std::size_t count, const Body& body, std::size_t grain = 1) {
  internal::parallel_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Calls `body(begin, end)` for ranges that together cover [0, count) once; for bodies that own
/// scratch memory worth reusing from index to index.
template <class Body>
void for_each_range(std::size_t count, std::size_t grain, const Body& body) {
  internal::parallel_ranges(count, grain, body);
}

/// Calls each of `works` once, side by side where there are threads for it.
template <class... Work>
void run_side_by_side(const Work&... works) {
  const std::array<std::function<void()>, sizeof...(Work)> all{std::cref(works)...};
  for_each_index(all.size(), [&](std::size_t i) { all[i](); });
}

/// Exclusive prefix sums: `count + 1` numbers, the last one the total.
template <class Count>
std::vector<std::uint64_t> offsets_from_counts(std::size_t count, const Count& count_of) {
  std::vector<std::uint64_t> offsets(count + 1);
  for (std::size_t i = 0; i < count; ++i) offsets[i + 1] = offsets[i] + count_of(i);
  return offsets;
}

}  // namespace tet
