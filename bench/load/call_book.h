// The requests under way, and what they have brought.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>

#include "bench/load/request_sender.h"

namespace tet::load {

/// A request that can be given up while it is in a book.
class BookedCall {
 public:
  virtual ~BookedCall() = default;
  virtual void cancel() = 0;

 private:
  friend class CallBook;
  std::list<BookedCall*>::iterator place_;
};

/// Thread safety: any thread may call any member.
class CallBook {
 public:
  /// Gives all up, and waits until the last has left.
  ~CallBook();

  void enter(BookedCall& call);
  /// From here on nobody cancels it.
  void forget(BookedCall& call);
  /// The last thing that a call does.
  void left();

  /// Cancels all that are in.
  void give_up();

  void count(std::uint64_t tets, std::uint64_t bytes);
  Traffic traffic() const { return {tets_, bytes_}; }

 private:
  std::atomic<std::uint64_t> tets_{0}, bytes_{0};
  std::mutex mutex_;
  std::condition_variable all_left_;
  std::list<BookedCall*> calls_;
  std::size_t running_ = 0;
};

}  // namespace tet::load
