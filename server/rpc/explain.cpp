#include "server/rpc/explain.h"

#include <string>
#include <utility>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/octree/sizing.h"
#include "core/plan/joined/joined_plan.h"
#include "core/plan/vertex_field.h"
#include "core/volume/inside.h"
#include "proto/convert/status.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {

/// Tells a failure in other words; its details stay.
absl::Status retold(const absl::Status& status, std::string_view message) {
  absl::Status other(status.code(), absl::string_view(message.data(), message.size()));
  status.ForEachPayload(
      [&](absl::string_view url, const absl::Cord& bytes) { other.SetPayload(url, bytes); });
  return other;
}

/// What a failure without a reason of its own means where it happened.
struct Reasons {
  const char *not_found, *invalid, *precondition, *otherwise;
};
constexpr Reasons kOfFile{"GRID_NOT_IN_FILE", "UNREADABLE_FILE", "NOT_MESHABLE", "DISK"};
constexpr Reasons kOfField{"GRID_NOT_IN_FILE", "UNREADABLE_FILE", "NOT_A_FIELD", "DISK"};
constexpr Reasons kOfMesh{"INTERNAL", "INVALID_FIELD", "NOTHING_TO_MESH", "INTERNAL"};

/// After which whoever took the memory that a decoder lacked may be done with it.
constexpr absl::Duration kMemoryAgain = absl::Seconds(5);

/// Whether the system has ended a decoder, whose file may be read at another time.
bool was_short_of_memory(const absl::Status& status) {
  return absl::IsResourceExhausted(status) && reason_of(status) == "DECODER_MEMORY";
}

absl::Status with_reason_of(const absl::Status& status, const Reasons& reasons) {
  if (was_short_of_memory(status)) return with_retry(status, kMemoryAgain);
  if (has_reason(status)) return status;
  switch (status.code()) {
    case absl::StatusCode::kNotFound:
      return with_reason(status, reasons.not_found);
    case absl::StatusCode::kInvalidArgument:
      return with_reason(status, reasons.invalid);
    case absl::StatusCode::kFailedPrecondition:
      return with_reason(status, reasons.precondition);
    case absl::StatusCode::kResourceExhausted:
      return with_reason(status, "LIMIT_EXCEEDED");
    case absl::StatusCode::kCancelled:
      return with_reason(status, "CANCELLED");
    case absl::StatusCode::kDeadlineExceeded:
      return with_reason(status, "DEADLINE_EXCEEDED");
    default:
      return with_reason(status, reasons.otherwise);
  }
}

}  // namespace

absl::Status about_file(const absl::Status& status,
                        std::string_view digest,
                        std::string_view path,
                        GridUse use) {
  if (status.ok()) return status;
  const std::string message = absl::StrReplaceAll(std::string(status.message()),
                                                  {{std::string(path), name_of_grid(digest)}});
  return with_reason_of(retold(status, message), use == GridUse::kField ? kOfField : kOfFile);
}

absl::Status about_field(const absl::Status& status, std::size_t i) {
  const std::string field = absl::StrCat(kFieldsField, "[", i, "]");
  absl::Status told = retold(status, absl::StrCat(field, ": ", status.message()));
  const bool is_wrong = absl::IsNotFound(status) || absl::IsInvalidArgument(status) ||
                        absl::IsFailedPrecondition(status);
  return is_wrong ? with_field(std::move(told), absl::StrCat("mesh.", field)) : told;
}

absl::Status about_grid(const absl::Status& status, std::size_t i) {
  const std::string reason = reason_of(status);
  if (reason != kOfFile.not_found && reason != kOfFile.precondition) return status;
  return with_field(status, absl::StrCat("mesh.", kGridNamesField, "[", i, "]"));
}

absl::Status about_mesh(const absl::Status& status) {
  // What is below a default spacing, the name of a grid, or what its values tell is known only
  // now.
  if (absl::IsInvalidArgument(status) &&
      (absl::StartsWith(status.message(), absl::StrCat(kSizingField, ".")) ||
       absl::StartsWith(status.message(), absl::StrCat(kFieldsField, "[")) ||
       absl::StartsWith(status.message(), absl::StrCat(kInsideField, " ")))) {
    return within_field("mesh", invalid_field(std::string(status.message())));
  }
  return status.ok() ? status : with_reason_of(status, kOfMesh);
}

}  // namespace tet
