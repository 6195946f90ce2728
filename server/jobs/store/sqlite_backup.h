// Copies of a database of jobs that is in use.
#pragma once

#include <filesystem>
#include <set>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/jobs/store/job.h"

namespace tet {

/// Copies the database as it is at one moment, whoever writes to it meanwhile, into one file
/// that appears whole or not at all. Errors: kNotFound (there is no database), kUnavailable,
/// kResourceExhausted (JOB_STORE_FULL), kInternal (JOB_STORE_BROKEN).
absl::Status back_up_sqlite(const std::filesystem::path& from, const std::filesystem::path& to);

/// Has SQLite look at every page and index. Errors: kInternal (JOB_STORE_BROKEN: what it
/// found), kUnavailable.
absl::Status check_sqlite(const std::filesystem::path& database);

/// What the jobs of a database read that are not finished. Errors: as above.
absl::StatusOr<std::set<JobInput>> inputs_of_sqlite(const std::filesystem::path& database);

}  // namespace tet
