// The first look at a file: is it there, is it one, may it be read?
#pragma once

#include <string>

#include <absl/status/status.h>

namespace tet {

/// Errors: kNotFound, kPermissionDenied, kInvalidArgument (a directory, say); with the path.
absl::Status check_file(const std::string& path);

}  // namespace tet
