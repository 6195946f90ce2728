// What the server says of a failure besides its code and message.
#pragma once

#include <optional>
#include <string>

#include <absl/status/status.h>
#include <absl/time/time.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include "google/rpc/status.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// The server's status as ours, with its details as payloads (by their type's URL), and the id
/// under which the call is in the server's log if it answered. `context` is the call's, which
/// has ended.
absl::Status to_absl(const grpc::Status& status, const grpc::ClientContext& context);

/// Converts a failure that is part of an answer, with its details.
absl::Status to_absl(const google::rpc::Status& status);

absl::Status to_absl(const tetstream::v1::FrameRefusal& refusal);

/// The ErrorInfo's reason; empty when the server gave none.
std::string reason_of_failure(const absl::Status& status);
/// After how long it is worth asking again, if the server said so.
std::optional<absl::Duration> retry_delay(const absl::Status& status);
/// The id of the call in the server's log; empty if it never came there.
std::string request_id_of(const absl::Status& status);
/// The field that the BadRequest names first; empty if it names none.
std::string field_of_failure(const absl::Status& status);
/// One of the ErrorInfo's metadata, such as "limit"; empty if it has none of that name.
std::string metadata_of(const absl::Status& status, const std::string& key);

}  // namespace tet
