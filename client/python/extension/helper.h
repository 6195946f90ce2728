// A thread that does a call's work while whoever called is awake for signals.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
namespace tetstream::python {

/// Does one piece of work after another. Beginning a thread takes longer than a short call
/// does, so that each thread that calls keeps its helper.
class Helper {
 public:
  Helper();
  ~Helper() {
    const std::lock_guard lock(mutex_);
    thread_.request_stop();
    changed_.notify_all();
  }
  Helper(const Helper&) = delete;
  Helper& operator=(const Helper&) = delete;

  /// `work` lives until it is done.
  void begin(const std::function<void()>& work);
  bool is_done_within(std::chrono::milliseconds time);
  /// What the work threw, if anything; to be asked once it is done.
  std::exception_ptr failure() const { return failure_; }

  /// Threads do not live on in a process that was forked: call this there, on the one that
  /// does.
  static void note_fork();
  bool is_of_this_process() const;

 private:
  void serve(const std::stop_token& stop);

  const int forks_;  ///< that led to the process it is of
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* work_ = nullptr;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses the others
};

/// This thread's helper, for as long as one has it. A call that is made by a callback of
/// another, which has the helper, gets one of its own.
class HelperLease {
 public:
  HelperLease();
  ~HelperLease();
  HelperLease(const HelperLease&) = delete;
  HelperLease& operator=(const HelperLease&) = delete;

  Helper& operator*() const { return *helper_; }
  Helper* operator->() const { return helper_; }

 private:
  Helper* helper_;
};

}  // namespace tetstream::python
