// What the system says when a file cannot be had.
#pragma once

#include <string>

#include <absl/status/status.h>

namespace tet {

/// "cannot WHAT PATH: why", from `errno`. kNotFound, kPermissionDenied, kResourceExhausted (a
/// full disk) or kFailedPrecondition.
absl::Status io_error(const char* what, const std::string& path);

}  // namespace tet
