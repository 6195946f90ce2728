// The embedded engine's tables.
#pragma once

#include <absl/status/status.h>

#include "server/jobs/store/sqlite_connection.h"

namespace tet {

/// Makes the tables, or brings those of an earlier version up to date, in one transaction.
/// Errors: kFailedPrecondition (JOB_STORE_TOO_NEW).
absl::Status migrate_sqlite(SqliteConnection& connection);

}  // namespace tet
