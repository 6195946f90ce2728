#include "client/python/extension/helper.h"

#include <atomic>
#include <memory>
#include <utility>

namespace tetstream::python {
namespace {

std::atomic<int> forks{0};
thread_local std::unique_ptr<Helper> idle;

}  // namespace

Helper::Helper()
    : forks_(forks.load()), thread_([this](const std::stop_token& stop) { serve(stop); }) {}

void Helper::note_fork() {
  forks.fetch_add(1);
  // Its thread is not there, and would be waited for when this thread ends.
  static_cast<void>(idle.release());
}

bool Helper::is_of_this_process() const { return forks_ == forks.load(); }

void Helper::begin(const std::function<void()>& work) {
  const std::lock_guard lock(mutex_);
  failure_ = nullptr;
  work_ = &work;
  changed_.notify_all();
}

bool Helper::is_done_within(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, time, [&] { return work_ == nullptr; });
}

void Helper::serve(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return work_ != nullptr || stop.stop_requested(); });
    if (work_ == nullptr) return;
    lock.unlock();
    try {
      (*work_)();
    } catch (...) {
      failure_ = std::current_exception();
    }
    lock.lock();
    work_ = nullptr;
    changed_.notify_all();
  }
}

HelperLease::HelperLease() {
  if (idle && !idle->is_of_this_process()) static_cast<void>(idle.release());
  std::unique_ptr<Helper> helper = std::move(idle);
  if (!helper) helper = std::make_unique<Helper>();
  helper_ = helper.release();
}

HelperLease::~HelperLease() {
  std::unique_ptr<Helper> helper(helper_);
  if (!idle) idle = std::move(helper);
}

}  // namespace tetstream::python
