// Small files that people write by hand.
#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace tet {

/// Errors: kNotFound, with the path.
absl::StatusOr<std::string> read_text_file(const std::string& path);

/// Puts the path of the file that a failure is about in front of its message.
absl::Status about(const std::string& path, const absl::Status& status);

}  // namespace tet
