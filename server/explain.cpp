#include "server/explain.h"

#include <string>

#include <absl/strings/str_replace.h>

#include "proto/wire/sha256.h"
#include "server/status.h"

namespace tet {

namespace {

/// The same failure in other words; its details stay.
absl::Status retold(const absl::Status& status, std::string_view message) {
  absl::Status other(status.code(), absl::string_view(message.data(), message.size()));
  status.ForEachPayload(
      [&](absl::string_view url, const absl::Cord& bytes) { other.SetPayload(url, bytes); });
  return other;
}

const char* file_reason(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kNotFound:
      return "GRID_NOT_IN_FILE";
    case absl::StatusCode::kInvalidArgument:
      return "UNREADABLE_FILE";
    case absl::StatusCode::kFailedPrecondition:
      return "NOT_MESHABLE";
    case absl::StatusCode::kResourceExhausted:
      return "LIMIT_EXCEEDED";
    default:
      return "DISK";
  }
}

const char* mesh_reason(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
      return "INVALID_FIELD";
    case absl::StatusCode::kFailedPrecondition:
      return "NOTHING_TO_MESH";
    case absl::StatusCode::kResourceExhausted:
      return "LIMIT_EXCEEDED";
    case absl::StatusCode::kCancelled:
      return "CANCELLED";
    case absl::StatusCode::kDeadlineExceeded:
      return "DEADLINE_EXCEEDED";
    default:
      return "INTERNAL";
  }
}

}  // namespace

absl::Status about_file(const absl::Status& status,
                        std::string_view digest,
                        std::string_view path) {
  if (status.ok()) return status;
  const std::string message = absl::StrReplaceAll(
      std::string(status.message()), {
                                         {std::string(path), name_of_grid(digest)}
  });
  const absl::Status told = retold(status, message);
  return has_reason(told) ? told : with_reason(told, file_reason(told.code()));
}

absl::Status about_mesh(const absl::Status& status) {
  if (status.ok() || has_reason(status)) return status;
  return with_reason(status, mesh_reason(status.code()));
}

}  // namespace tet
