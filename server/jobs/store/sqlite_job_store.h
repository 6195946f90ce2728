// The embedded engine: one file on one machine, shared by any number of its processes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/store/sql_job_store.h"

namespace tet {

struct SqliteOptions {
  std::string path;  ///< made when missing; ":memory:" is gone with the store
  /// How long to wait for another process's transaction.
  absl::Duration busy_timeout = absl::Seconds(10);
  std::function<absl::Time()> clock = absl::Now;  ///< of this machine: the store's time
  SqlJobStore::Options rules = {};
  bool patient = false;  ///< see open_sqlite_job_store
  /// A file of so many bytes beside the database, given up where the disk is full.
  std::uint64_t ballast_bytes = 0;
};

/// Opens the store and brings its schema up to date. The file must not be on a network file
/// system. Patience takes a disk that is full, or a file that others keep busy, for something
/// that will pass: the store is there, its calls fail, and each tries anew. Errors:
/// kFailedPrecondition (JOB_STORE_TOO_NEW: a later version wrote it), kUnavailable,
/// kResourceExhausted (JOB_STORE_FULL), kInternal (JOB_STORE_BROKEN: not a database, cannot be
/// made).
absl::StatusOr<std::unique_ptr<JobStore>> open_sqlite_job_store(const SqliteOptions& options);

}  // namespace tet
