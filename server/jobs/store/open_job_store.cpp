#include "server/jobs/store/open_job_store.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "server/jobs/store/postgres_job_store.h"
#include "server/jobs/store/sqlite_job_store.h"

namespace tet {

namespace {

// Enough to cancel a job of ten thousand shards.
constexpr std::uint64_t kBallastBytes = std::uint64_t{16} << 20;

}  // namespace

bool is_postgres(const std::string& where) {
  return absl::StartsWith(where, "postgresql://") || absl::StartsWith(where, "postgres://");
}

absl::StatusOr<std::unique_ptr<JobStore>> open_job_store(const std::string& where,
                                                         const SqlJobStore::Options& rules) {
  if (is_postgres(where)) {
    PostgresOptions options;
    options.connection = where;
    options.rules = rules;
    options.patient = true;
    return open_postgres_job_store(options);
  }
  SqliteOptions options;
  options.path = where;
  options.rules = rules;
  options.patient = true;
  options.ballast_bytes = kBallastBytes;
  auto store = open_sqlite_job_store(options);
  if (store.ok()) return store;
  // Said to whoever starts the server, who may not know that there is such a file.
  return absl::Status(
      store.status().code(),
      absl::StrCat("the jobs in '", where, "' cannot be opened: ", store.status().message()));
}

}  // namespace tet
