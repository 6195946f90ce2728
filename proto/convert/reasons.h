// Every reason that an ErrorInfo may carry; docs/errors.md says what each means.
#pragma once

#include <algorithm>
#include <string_view>

namespace tet {

/// In the order of the alphabet. A lint test holds this list, the sources and docs/errors.md
/// together.
// One a line, so that two that are added do not meet.
// clang-format off
inline constexpr std::string_view kReasons[] = {
    "CANCELLED",
    "CHUNK_DAMAGED",
    "CHUNK_RANGE",
    "CLIENT_STALLED",
    "DEADLINE_EXCEEDED",
    "DECODER_CRASHED",
    "DECODER_MEMORY",
    "DECODER_RESULT",
    "DECODER_TIMEOUT",
    "DECODER_UNAVAILABLE",
    "DETERMINISM_ALARM",
    "DISK",
    "DISK_FULL",
    "GRID_NOT_FOUND",
    "GRID_NOT_IN_FILE",
    "INTERNAL",
    "INVALID_DIGESTS",
    "INVALID_FIELD",
    "INVALID_PLAN",
    "JOB_ACTIVE",
    "JOB_CANCELLED",
    "JOB_EXPIRED",
    "JOB_NOT_FOUND",
    "JOB_NOT_SUCCEEDED",
    "JOB_STORE_BROKEN",
    "JOB_STORE_FULL",
    "JOB_STORE_TOO_NEW",
    "JOB_STORE_UNAVAILABLE",
    "JOB_SUCCEEDED",
    "JOB_TIMEOUT",
    "LEASE_EXPIRED",
    "LEASE_LOST",
    "LIMIT_EXCEEDED",
    "MALFORMED",
    "MESSAGE_ORDER",
    "NOTHING_TO_MESH",
    "NOT_A_FIELD",
    "NOT_MESHABLE",
    "NO_ANSWER",
    "OTHER_MESH",
    "QUOTA_EXCEEDED",
    "RANGE_BEYOND_MESH",
    "REQUEST_ID_REUSED",
    "RESULTS_FULL",
    "RESULTS_HELD_BY_JOBS",
    "REVISION_COMPACTED",
    "REVISION_UNKNOWN",
    "SCOPE_MISSING",
    "SERVER_BUSY",
    "SHUTTING_DOWN",
    "STORED_GRID_CORRUPT",
    "STORE_BUSY",
    "STORE_HELD_BY_JOBS",
    "TOKEN_EXPIRED",
    "TOKEN_MISSING",
    "TOKEN_UNKNOWN",
    "TOO_MUCH_DATA",
    "UNREADABLE_FILE",
    "UPLOAD_IN_PROGRESS",
    "WRONG_DIGEST",
    "WRONG_OFFSET",
    "WRONG_STORE",
};
// clang-format on

constexpr bool is_reason(std::string_view name) {
  return std::find(std::begin(kReasons), std::end(kReasons), name) != std::end(kReasons);
}

}  // namespace tet
