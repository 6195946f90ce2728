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

/// Whether with_reason gave one.
bool has_reason(const absl::Status& status);

/// The ErrorInfo's reason: what with_reason gave, else the code's name; empty for kOk.
std::string reason_of(const absl::Status& status);

/// kInvalidArgument with reason INVALID_FIELD; `message` begins with the field's name, and says
/// its value and what it may be. The name is also in a BadRequest.
absl::Status invalid_field(const std::string& message);

/// Names the field that led to a failure of another reason, in a BadRequest.
absl::Status with_field(absl::Status status, const std::string& field);

/// Tells the same failure where its field belongs to the message in field `outer`.
absl::Status within_field(std::string_view outer, const absl::Status& status);

/// Says that it is worth trying again after `delay`.
absl::Status with_retry(absl::Status status, absl::Duration delay);
/// Whether with_retry said so.
bool has_retry(const absl::Status& status);

/// kResourceExhausted: "`what`: `value` is over the limit of `limit`", the numbers also in the
/// ErrorInfo's metadata.
absl::Status over_limit(std::string_view what,
                        std::uint64_t value,
                        std::uint64_t limit,
                        std::string_view reason = "LIMIT_EXCEEDED");

/// Says whose quota was used up (`client:...`, `namespace:...`), and how: a QuotaFailure.
absl::Status with_quota(absl::Status status,
                        const std::string& subject,
                        const std::string& description);

/// over_limit with reason QUOTA_EXCEEDED, for what one client may have.
absl::Status over_quota(const std::string& client,
                        const std::string& what,
                        std::uint64_t value,
                        std::uint64_t limit);

/// Does the same for what one namespace may have.
absl::Status over_space_quota(const std::string& space,
                              const std::string& what,
                              std::uint64_t value,
                              std::uint64_t limit);

/// The only place where our failures become gRPC's: the same code, an ErrorInfo with
/// reason_of's reason, the other details, and the message in printable ASCII. All of it takes
/// at most kMaxStatusBytes; where it would not, the message is cut, and details but the
/// ErrorInfo go.
inline constexpr std::size_t kMaxStatusBytes = 1024;
grpc::Status to_grpc(const absl::Status& status);

}  // namespace tet
