// A night on the farm, played from a seed: clients, workers, a clock and accidents over the
// real store in memory, on a clock that the play sets.
#pragma once

#include <cstdint>
#include <string>

namespace tet::test {

struct Simulated {
  std::string violation;    ///< empty if every promise was kept
  std::uint64_t trace = 0;  ///< hash of all that happened, the same for the same seed
  int commits = 0, lost_leases = 0, crashes = 0, finished = 0, dead = 0;
};

/// Plays `steps` random steps, then lets honest workers finish what is there.
///
/// Promises: a job that was acknowledged is there and comes to an end; no shard is committed
/// under two tokens; no token commits after a larger one was given out for its shard; nothing
/// is committed after a cancel was answered; events tell each version of each job once, in
/// order, and end in the job's state.
Simulated simulate(std::uint64_t seed, int steps);

}  // namespace tet::test
