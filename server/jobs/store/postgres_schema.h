// The tables of the engine for many machines, and their partitions.
#pragma once

#include <cstdint>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/store/postgres_connection.h"

namespace tet {

/// Makes the tables, or brings those of an earlier version up to date, while all others wait.
/// Errors: kFailedPrecondition (JOB_STORE_TOO_NEW).
absl::Status migrate_postgres(PostgresConnection& connection);

/// Makes the partitions for jobs of now and of the next few spans, where they are missing. What
/// has no partition of its own goes to the default one.
absl::Status make_partitions(PostgresConnection& connection, absl::Duration span);

/// Drops partitions in which every job finished before, with all their rows; deletes such jobs
/// from the default partition. Says how many jobs went.
absl::StatusOr<std::int64_t> drop_partitions(PostgresConnection& connection,
                                             std::int64_t finished_before_us);

}  // namespace tet
