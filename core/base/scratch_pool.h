// Scratch memory that tasks take turns with.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace tet {

/// Keeps scratch memory for as many tasks as run at a time, however many there are in all: a
/// new piece is made only when none lies idle. Thread-safe.
template <class Scratch>
class ScratchPool {
 public:
  /// Gives it back in the end.
  class Turn {
   public:
    explicit Turn(ScratchPool& pool) : pool_(pool), scratch_(pool.take()) {}
    ~Turn() { pool_.give_back(std::move(scratch_)); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

    Scratch& operator*() const noexcept { return *scratch_; }
    Scratch* operator->() const noexcept { return scratch_.get(); }

   private:
    ScratchPool& pool_;
    std::unique_ptr<Scratch> scratch_;
  };

 private:
  std::unique_ptr<Scratch> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Scratch> scratch = std::move(idle_.back());
        idle_.pop_back();
        return scratch;
      }
    }
    return std::make_unique_for_overwrite<Scratch>();
  }
  void give_back(std::unique_ptr<Scratch> scratch) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(scratch));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> idle_;
};

}  // namespace tet
