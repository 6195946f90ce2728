// What a store's answers tell of its clock and of this machine's.
#pragma once

#include <chrono>
#include <optional>

#include <absl/time/time.h>

namespace tet {

/// Compares clocks by looks at them that take a while: whoever asks may stand still in between,
/// and the store may answer late. Nothing is concluded that such a pause would explain, too.
class ClockWatch {
 public:
  using Steady = std::chrono::steady_clock;

  /// Clocks that differ by more are told of, and a store's clock that jumps by more has
  /// stepped.
  static constexpr absl::Duration kFewSeconds = absl::Seconds(5);

  /// All of it was read between `asked` and `answered`.
  struct Look {
    absl::Time store;
    absl::Time here;
    Steady::time_point asked;
    Steady::time_point answered;
  };

  struct Finding {
    absl::Duration ahead;                ///< of this machine's clock against the store's
    bool differs = false;                ///< by more than a few seconds, for certain
    std::optional<absl::Duration> step;  ///< of the store's clock since the look before
  };

  Finding compare(const Look& look);

 private:
  /// A time, and how far off it may be.
  struct Ahead {
    absl::Duration time, doubt;
  };

  std::optional<Ahead> store_ahead_;  ///< of the monotonic clock, at the look before
};

}  // namespace tet
