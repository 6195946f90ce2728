// Memory of rings that no stream uses now, kept for the next stream of its connection.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/shared_memory/ring_memory.h"
#include "server/shared_memory/side_connection.h"

namespace tet {

/// Each connection may have one ring here. It stays charged to its client; whoever needs what
/// is charged has all of it given up. Thread-safe, and never locked while memory is given up.
class KeptMemory {
 public:
  using Clock = std::chrono::steady_clock;

  /// What nobody has used for so long is given up, unless another time is set.
  static constexpr std::chrono::seconds kIdle{10};

  /// Keeps `most_bytes` of all connections together; what has been here longest goes first.
  explicit KeptMemory(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// To be called before anything is kept.
  void keep_for(Clock::duration idle) noexcept { idle_ = idle; }
  /// Keeps what the last stream of a connection has used.
  void keep(const std::shared_ptr<SideConnection>& connection,
            std::shared_ptr<RingMemory> memory);
  /// The memory of this connection, if it is charged to that client and large enough; null
  /// otherwise, and then what was here for the connection is given up.
  std::shared_ptr<RingMemory> take(const std::shared_ptr<SideConnection>& connection,
                                   const std::string& client,
                                   RingSize least);
  /// Gives up what was idle for too long, and that of connections that are gone.
  void give_up_idle(Clock::time_point now);
  /// Gives up all there is. False where there was nothing.
  bool give_up_all();
  std::uint64_t bytes() const;

 private:
  struct Kept {
    std::weak_ptr<SideConnection> connection;
    std::shared_ptr<RingMemory> memory;
    Clock::time_point since;
  };

  template <class Goes>
  std::vector<Kept> remove_if(const Goes& goes);

  const std::uint64_t most_bytes_;
  Clock::duration idle_ = kIdle;
  mutable std::mutex mutex_;
  std::vector<Kept> kept_;  ///< in the order in which it came
  std::uint64_t bytes_ = 0;
};

}  // namespace tet
