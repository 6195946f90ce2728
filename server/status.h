// Failures: absl::Status within the server, grpc::Status with google.rpc details on the wire.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/time/time.h>
#include <grpcpp/support/status.h>

namespace tet {

/// Names the failure for programs: the ErrorInfo's reason, UPPER_SNAKE_CASE.
absl::Status with_reason(absl::Status status, std::string_view reason);

/// kInvalidArgument with reason INVALID_FIELD; `message` names the field, its value and what it
/// may be.
absl::Status invalid_field(const std::string& message);

/// Says that it is worth trying again after `delay`.
absl::Status with_retry(absl::Status status, absl::Duration delay);

/// kResourceExhausted: "`what`: `value` is over the limit of `limit`", the numbers also in the
/// ErrorInfo's metadata.
absl::Status over_limit(std::string_view what,
                        std::uint64_t value,
                        std::uint64_t limit,
                        std::string_view reason = "LIMIT_EXCEEDED");

/// Says whose quota was used up, and how: a QuotaFailure.
absl::Status with_quota(absl::Status status,
                        const std::string& subject,
                        const std::string& description);

/// over_limit with reason QUOTA_EXCEEDED, for what one client may have.
absl::Status over_quota(const std::string& client,
                        const std::string& what,
                        std::uint64_t value,
                        std::uint64_t limit);

/// The only place where our failures become gRPC's: the same code and message, and an ErrorInfo
/// whose reason is the code's name unless with_reason gave a better one.
grpc::Status to_grpc(const absl::Status& status);

}  // namespace tet
