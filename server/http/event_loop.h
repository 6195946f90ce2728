// The thread of the HTTP port: it waits for sockets and for what other threads hand it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/wake_event.h"

namespace tet {

/// Runs all that happens to connections on one thread, so that none of it needs a lock.
///
/// Thread safety: `post` may be called by any thread; the rest on the loop's own, but for
/// construction and destruction.
class EventLoop {
 public:
  using Task = std::function<void()>;
  /// Told which of EPOLLIN, EPOLLOUT, EPOLLRDHUP, EPOLLHUP and EPOLLERR came.
  using Watcher = std::function<void(std::uint32_t events)>;

  /// `tick` is called about every `interval`.
  EventLoop(std::chrono::milliseconds interval, Task tick);
  ~EventLoop() { stop(); }
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Has the thread begin.
  void start();
  /// Ends the thread once nothing holds the loop and all that was posted is done. Called by
  /// another thread; the second time it does nothing.
  void stop();
  void post(Task task);

  /// Keeps the loop running until `release`.
  void hold() noexcept { ++held_; }
  void release() noexcept { --held_; }

  /// Calls `watcher` when one of `events` comes. Once a descriptor.
  void watch(int descriptor, std::uint32_t events, Watcher watcher);
  void change(int descriptor, std::uint32_t events);
  /// Calls its watcher no more, not even for what has come already.
  void forget(int descriptor);

 private:
  void run();
  void wait();
  bool do_posted();
  void control(int operation, int descriptor, std::uint32_t events);

  const std::chrono::milliseconds interval_;
  const Task tick_;
  Descriptor epoll_;
  WakeEvent wake_;
  std::map<int, std::shared_ptr<Watcher>> watchers_;
  std::mutex mutex_;
  std::vector<Task> posted_;
  bool stopping_ = false;
  int held_ = 0;
  std::thread thread_;
};

}  // namespace tet
