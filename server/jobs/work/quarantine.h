// When a worker keeps its hands off, because it was its own fault that work failed.
#pragma once

#include <cstdint>
#include <mutex>

#include <absl/status/status.h>
#include <absl/time/time.h>

namespace tet {

/// A worker in quarantine claims nothing for a while, which doubles each time until it has done
/// something again. Thread-safe.
class Quarantine {
 public:
  static constexpr absl::Duration kFirstPause = absl::Seconds(1);
  static constexpr absl::Duration kLongestPause = absl::Seconds(30);

  /// Something failed for a reason of the worker's own. True if it was free before.
  bool enter(const absl::Status& why);
  /// What was wrong is right again, as far as can be told. True if it was in quarantine.
  bool leave();
  /// A shard was done: what comes next is a new trouble.
  void worked();

  /// Why the worker takes nothing; OK while it does.
  absl::Status trouble() const;
  /// How long it is to wait before it looks again.
  absl::Duration pause() const;
  /// How often it came into quarantine.
  std::int64_t count() const;

 private:
  mutable std::mutex mutex_;
  absl::Status trouble_;
  int failures_ = 0;  ///< since a shard was done
  std::int64_t count_ = 0;
};

}  // namespace tet
