// A stream's place at the mesher, which it has only while there is something to make for it.
#pragma once

#include <chrono>
#include <mutex>

#include "server/rpc/admission.h"

namespace tet {

/// Holds a place from its admission on. Where nothing is made for a while, because the reader
/// takes nothing or others have all blocks for chunks, the place goes to others; the stream
/// keeps its part of its client's share, and comes back without asking once there is something
/// to make: what it makes then is shared fairly, chunk by chunk.
///
/// Thread-safe.
class MesherTurn {
 public:
  using Clock = std::chrono::steady_clock;

  explicit MesherTurn(Admission& admission) : admission_(admission) {}
  ~MesherTurn() { give_back(); }

  void take(Ticket place);
  /// What was to be found out first is known: from now on all work is told.
  void opened();
  void give_back();

  /// A piece of work begins, or ends: any number at once.
  void begin();
  void end();

  /// Lends the place to others if nothing was made since `then`; to be called every now and
  /// then.
  void lend_if_idle_since(Clock::time_point then);

 private:
  Admission& admission_;
  std::mutex mutex_;  ///< guards all below; never held while others are answered
  Ticket place_;
  bool opened_ = false, lent_ = false;
  int running_ = 0;
  Clock::time_point idle_since_{};
};

}  // namespace tet
