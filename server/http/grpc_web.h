// gRPC-Web's frames: a message or the trailers, behind five bytes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>
#include <grpcpp/support/status.h>

namespace tet {

using Trailers = std::vector<std::pair<std::string, std::string>>;

/// Returns the one message that a call's body has.
/// Errors: kInvalidArgument (no frame, more than one, one that says another length than it has,
/// one of trailers), kUnimplemented (a compressed one).
absl::StatusOr<absl::string_view> message_in(absl::string_view body);

/// Returns the five bytes before a message of this size.
std::string frame_prefix(std::size_t message_bytes);

/// Returns the frame that ends an answer.
std::string trailers_frame(const grpc::Status& status, const Trailers& trailers);

/// Returns a message as `grpc-message` has it: anything but printable ASCII as %XX.
std::string encode_message(absl::string_view message);

/// Reads a `grpc-timeout`: at most eight digits and a unit (H, M, S, m, u, n).
std::optional<std::chrono::nanoseconds> parse_timeout(absl::string_view text);

}  // namespace tet
