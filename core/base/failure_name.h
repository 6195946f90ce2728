// A failure's name for programs, beside its message for people.
#pragma once

#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/strings/string_view.h>

namespace tet {

/// Names the failure, UPPER_SNAKE_CASE; a server sends it as the ErrorInfo's reason.
absl::Status named_failure(std::string_view name, absl::Status status);

/// The name that `named_failure` gave; empty if there is none.
std::string failure_name(const absl::Status& status);

/// Under which a status keeps its name, among its payloads.
inline constexpr absl::string_view kFailureNameUrl = "tetstream/failure-name";

}  // namespace tet
