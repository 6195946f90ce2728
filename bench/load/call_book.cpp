#include "bench/load/call_book.h"

namespace tet::load {

CallBook::~CallBook() {
  give_up();
  std::unique_lock lock(mutex_);
  all_left_.wait(lock, [this] { return running_ == 0; });
}

void CallBook::enter(BookedCall& call) {
  const std::lock_guard lock(mutex_);
  call.place_ = calls_.insert(calls_.end(), &call);
  ++running_;
}

void CallBook::forget(BookedCall& call) {
  const std::lock_guard lock(mutex_);
  calls_.erase(call.place_);
}

void CallBook::left() {
  const std::lock_guard lock(mutex_);
  if (--running_ == 0) all_left_.notify_all();
}

void CallBook::give_up() {
  const std::lock_guard lock(mutex_);
  for (BookedCall* call : calls_) call->cancel();
}

void CallBook::count(std::uint64_t tets, std::uint64_t bytes) {
  tets_.fetch_add(tets, std::memory_order_relaxed);
  bytes_.fetch_add(bytes, std::memory_order_relaxed);
}

}  // namespace tet::load
