// Whether jobs can be taken and done now: their database and the disk of their results.
#pragma once

#include <absl/status/status.h>

#include "server/jobs/store/job_store.h"
#include "server/jobs/work/work_place.h"
#include "server/ops/probe.h"

namespace tet {

/// Writes a little to both every now and then, and soon again while that fails; logs when it
/// begins to fail and when it works again. Thread-safe.
class JobHealth {
 public:
  /// All references must outlive it.
  JobHealth(JobStore& jobs, WorkPlace& place, const ResultStore& results)
      : probe_("jobs", [&jobs, &place, &results] {
          const absl::Status written = jobs.probe();
          return written.ok() ? place.check(results) : written;
        }) {}

  /// How writing went the last time. Errors: those of JobStore::probe and WorkPlace::check;
  /// kUnavailable (NO_ANSWER) while it takes too long.
  absl::Status status() const { return probe_.status(); }

 private:
  Probe probe_;
};

}  // namespace tet
