// Turns at what is for one thread at a time.
#pragma once

#include <atomic>
#include <string>

#include "client/python/extension/watch.h"

namespace tetstream::python {

/// Keeps two threads out of one object: raises where another one is in it.
class Turn {
 public:
  Turn(std::atomic<bool>& busy, const std::string& object) : busy_(busy) {
    if (busy_.exchange(true)) {
      raise_error({StatusCode::kFailedPrecondition,
                   "another thread is in this " + object + ": take turns"});
    }
  }
  ~Turn() { busy_ = false; }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  std::atomic<bool>& busy_;
};

}  // namespace tetstream::python
