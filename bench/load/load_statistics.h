// What is known of a run, while it goes on and when it is over.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <vector>

#include "bench/load/load_plan.h"
#include "bench/load/request_sender.h"
#include "bench/load/tally.h"

namespace tet::load {

/// What one part of a run received and cost.
struct Window {
  double seconds = 0;
  Traffic received;
  double generator_cpu_seconds = 0;  ///< of this process, user and system
};

/// Thread safety: any thread may call any member.
class LoadStatistics {
 public:
  LoadStatistics(std::size_t steps, std::size_t entries);

  /// A request was sent, `queued` when it had to wait for others first.
  void sent(const LoadRequest& request, TimePoint when, bool queued);
  void offered(const LoadRequest& request);
  void dropped(const LoadRequest& request);
  void done(const LoadRequest& request, const Outcome& outcome);
  void failed(const LoadRequest& request, const absl::Status& status);
  void unfinished(const LoadRequest& request, const Outcome& outcome);

  /// The measured part begins; it ends. What arrives outside is not part of any rate.
  void begin_window(const Traffic& traffic);
  void end_window(const Traffic& traffic);

  /// Everything measured so far.
  Tally total() const;
  Tally of_step(std::size_t step) const;
  Tally of_entry(std::size_t entry) const;
  Window window() const;

  /// What happened since the last call, the warm-up included.
  Tally take_recent();

 private:
  struct Mark {
    TimePoint when;
    Traffic traffic;
    double cpu_seconds = 0;
  };
  static Mark mark(const Traffic& traffic);

  /// Calls `change(tally)` for every tally that the request is part of.
  template <class Change>
  void change(const LoadRequest& request, const Change& change);

  mutable std::mutex mutex_;
  Tally total_, recent_;
  std::vector<Tally> steps_, entries_;
  std::optional<Mark> begin_, end_;
};

}  // namespace tet::load
