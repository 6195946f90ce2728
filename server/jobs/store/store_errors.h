// How the store's failures are worded: reasons that programs can act on.
#pragma once

#include <string>

#include <absl/status/status.h>

namespace tet {

/// The database does not answer or is busy: worth trying again.
absl::Status store_unavailable(const std::string& message);
absl::Status store_full(const std::string& message);
/// The database is damaged or is none: no caller can mend that.
absl::Status store_broken(const std::string& message);

/// Whether a failure is the database's, and may pass: it does not answer, is busy or full.
bool will_pass(const absl::Status& status);

absl::Status job_not_found(const std::string& id);
/// Somebody else has the shard, or the job was stopped.
absl::Status lease_lost(const std::string& message);

/// Bytes of a google.rpc.Status with all of the status's details; empty for OK.
std::string encode_status(const absl::Status& status);
absl::Status decode_status(const std::string& bytes);

}  // namespace tet
