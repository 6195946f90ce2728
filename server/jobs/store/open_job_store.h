// Where jobs are kept, by name.
#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/jobs/store/job_store.h"
#include "server/jobs/store/sql_job_store.h"

namespace tet {

/// Whether `where` is an address of PostgreSQL's.
bool is_postgres(const std::string& where);

/// Opens `where`: a postgresql:// address (or postgres://), else a file of SQLite's. Patiently:
/// a database that does not answer now, or whose disk is full, keeps nobody from starting.
/// Errors:
/// those of open_postgres_job_store and open_sqlite_job_store; the file is named, an address is
/// not, since a password may stand in it.
absl::StatusOr<std::unique_ptr<JobStore>> open_job_store(
    const std::string& where, const SqlJobStore::Options& rules = {});

}  // namespace tet
