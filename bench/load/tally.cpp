#include "bench/load/tally.h"

namespace tet::load {
namespace {

void add_latencies(const LoadRequest& request,
                   const Outcome& outcome,
                   std::array<LatencyHistogram, 3>& latencies) {
  const auto add = [&](LatencyKind kind, TimePoint end) {
    latencies[static_cast<std::size_t>(kind)].add(end - request.intended);
  };
  add(LatencyKind::kHeader, outcome.header.value_or(outcome.ended));
  add(LatencyKind::kFirstChunk, outcome.first_chunk.value_or(outcome.ended));
  add(LatencyKind::kWhole, outcome.ended);
}

}  // namespace

void Tally::add_done(const LoadRequest& request, const Outcome& outcome) {
  ++done;
  add_latencies(request, outcome, done_latency);
}

void Tally::add_failed(const absl::Status& status) {
  ++failed;
  ++errors[status.code()];
  error_messages.try_emplace(status.code(), status.message());
}

void Tally::add_unfinished(const LoadRequest& request, const Outcome& outcome) {
  ++unfinished;
  add_latencies(request, outcome, unfinished_latency);
}

LatencyHistogram Tally::latency(LatencyKind kind) const {
  LatencyHistogram both = done_latency[static_cast<std::size_t>(kind)];
  both.add(unfinished_latency[static_cast<std::size_t>(kind)]);
  return both;
}

std::uint64_t Tally::missed(const LatencyGoal& goal) const {
  const auto& latencies = done_latency[static_cast<std::size_t>(goal.kind)];
  return offered - (done - latencies.count_above(goal.limit));
}

bool Tally::holds(const LatencyGoal& goal) const {
  const auto allowed = (1 - goal.fraction) * static_cast<double>(offered);
  // 1 - 0.99 is a little more than 0.01, and a quantile is a rank: round as one.
  return offered > 0 && static_cast<double>(missed(goal)) <= allowed * (1 + 1e-9);
}

}  // namespace tet::load
