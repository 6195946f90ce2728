// How long PostgreSQL waits for whoever is in the middle of a transaction.
#pragma once

#include <absl/time/time.h>

namespace tet {

/// A process that is paused or cut off in the middle of a transaction keeps its rows locked:
/// until the server ends the session, which must be before those who wait for them give up.
constexpr absl::Duration kIdleInTransaction = absl::Seconds(3);

}  // namespace tet
