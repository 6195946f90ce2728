// Small files that people write by hand.
#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace tet {

/// Errors: kNotFound, with the path.
absl::StatusOr<std::string> read_text_file(const std::string& path);

/// The same failure, with the path of the file that it is about.
absl::Status about(const std::string& path, const absl::Status& status);

}  // namespace tet
