// Small files that people write by hand, or that other programs pipe in.
#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"

namespace tet {

/// Reads to the end; waits for it where the path leads to a pipe or a terminal, for as long as
/// `cancellation` allows. Errors: kNotFound, with the path; those of check_cancelled.
absl::StatusOr<std::string> read_text_file(const std::string& path,
                                           const Cancellation& cancellation);
absl::StatusOr<std::string> read_text_file(const std::string& path);

/// Reads what comes on standard input, in the same way.
absl::StatusOr<std::string> read_standard_input(const Cancellation& cancellation);

/// Puts the path of the file that a failure is about in front of its message.
absl::Status about(const std::string& path, const absl::Status& status);

}  // namespace tet
