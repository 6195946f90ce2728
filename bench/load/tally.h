// What became of a set of requests.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include <absl/status/status.h>

#include "bench/load/latency_goal.h"
#include "bench/load/latency_histogram.h"
#include "bench/load/request_sender.h"

namespace tet::load {

/// How many requests ended how. Once all have ended, offered = done + failed + unfinished +
/// dropped.
struct Tally {
  std::uint64_t offered = 0;     ///< fell due
  std::uint64_t done = 0;        ///< got their whole mesh
  std::uint64_t failed = 0;      ///< the server or the network said no
  std::uint64_t unfinished = 0;  ///< given up by us when the run ended
  std::uint64_t dropped = 0;     ///< never sent: too many were waiting
  std::uint64_t queued = 0;      ///< could not be sent at once: too many were outstanding
  std::map<absl::StatusCode, std::uint64_t> errors;        ///< of the failed
  std::map<absl::StatusCode, std::string> error_messages;  ///< the first of each code

  /// By LatencyKind, from the intended start: of those done, and of those unfinished until what
  /// came or until they were given up.
  std::array<LatencyHistogram, 3> done_latency, unfinished_latency;
  /// From the intended start until it was sent, of those that were not queued: the generator's
  /// own delay.
  LatencyHistogram lateness;

  /// Latencies of the done and the unfinished; for the latter they are lower bounds.
  LatencyHistogram latency(LatencyKind kind) const;

  void add_done(const LoadRequest& request, const Outcome& outcome);
  void add_failed(const absl::Status& status);
  void add_unfinished(const LoadRequest& request, const Outcome& outcome);

  /// How many of those offered did not come within the goal's limit: the slow ones, and all
  /// that failed, were given up or dropped.
  std::uint64_t missed(const LatencyGoal& goal) const;
  bool holds(const LatencyGoal& goal) const;
};

}  // namespace tet::load
