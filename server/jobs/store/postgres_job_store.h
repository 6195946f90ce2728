// The engine for many machines: PostgreSQL 15, shared by any number of servers and workers.
#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/store/idle_in_transaction.h"
#include "server/jobs/store/sql_job_store.h"

namespace tet {

struct PostgresOptions {
  /// What libpq is given: "host=db dbname=tetstream user=tetstream", or a postgresql://
  /// address.
  std::string connection = {};
  int max_connections = 8;  ///< of this process, beside the one that listens
  /// How often to look for changes whether notified or not.
  absl::Duration poll = absl::Seconds(1);
  absl::Duration idle_in_transaction = kIdleInTransaction;  ///< before it is ended
  /// Rows of jobs made in one such span share a partition, and go together.
  absl::Duration partition = absl::Hours(24);
  SqlJobStore::Options rules = {};
  bool patient = false;  ///< see open_postgres_job_store
};

/// Opens the store and brings its schema up to date; others that open it at the same time wait.
/// Patience takes a database that does not answer for something that will pass: the store is
/// there, its calls fail, and each tries anew. Errors: kFailedPrecondition (JOB_STORE_TOO_NEW:
/// a later version wrote it), kUnavailable (JOB_STORE_UNAVAILABLE: no connection; the message
/// says why, and never the password), kInternal.
absl::StatusOr<std::unique_ptr<JobStore>> open_postgres_job_store(
    const PostgresOptions& options);

}  // namespace tet
