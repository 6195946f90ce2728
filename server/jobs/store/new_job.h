// What a job may be asked for, checked once for both engines.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "server/jobs/store/job.h"

namespace tet {

inline constexpr std::int64_t kMaxPriority = 100;  ///< and as low below 0
inline constexpr std::int64_t kMaxAttempts = 100;

/// Errors: kInvalidArgument (INVALID_FIELD; names the field, its value and what it may be).
absl::Status check(const NewJob& job);

/// Errors: kInvalidArgument (INVALID_PLAN).
absl::Status check(const Plan& plan);

/// SHA-256 of all that was asked for, as hexadecimal text: two requests with one fingerprint
/// ask for the same job.
std::string fingerprint(const NewJob& job);

/// "\nkey=value\nkey=value\n", by key; empty without labels. A label is in a job's text if and
/// only if its own text is.
std::string encode_labels(const Labels& labels);
Labels decode_labels(const std::string& text);

/// Errors: kInvalidArgument (INVALID_FIELD).
absl::Status check_labels(const Labels& labels);

}  // namespace tet
