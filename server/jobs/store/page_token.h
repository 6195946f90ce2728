// Page tokens: where a list goes on, and the filter that it must go on with.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "server/jobs/store/job_store.h"

namespace tet {

/// Goes on after this job. Tokens are good for ever: they hold no state of the store's.
std::string make_page_token(const std::string& job, const JobFilter& filter);

/// The job to go on after; empty for the empty token, which is the first page.
/// Errors: kInvalidArgument (INVALID_FIELD: not a token, or one of another filter).
absl::StatusOr<std::string> job_after_token(const std::string& token, const JobFilter& filter);

}  // namespace tet
