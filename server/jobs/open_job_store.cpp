#include "server/jobs/open_job_store.h"

#include <absl/strings/match.h>

#include "server/jobs/postgres_job_store.h"
#include "server/jobs/sqlite_job_store.h"

namespace tet {

absl::StatusOr<std::unique_ptr<JobStore>> open_job_store(const std::string& where) {
  if (absl::StartsWith(where, "postgresql://") || absl::StartsWith(where, "postgres://")) {
    PostgresOptions options;
    options.connection = where;
    return open_postgres_job_store(options);
  }
  SqliteOptions options;
  options.path = where;
  return open_sqlite_job_store(options);
}

}  // namespace tet
