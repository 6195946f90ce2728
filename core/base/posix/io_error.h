// What the system says when a file cannot be had, as a status.
#pragma once

#include <filesystem>
#include <string_view>

#include <absl/status/status.h>

namespace tet {

/// Makes a status of `errno`: who calls this layer chooses how much of the path its own callers
/// may see. `action` completes "cannot ... PATH": "open", "write to".
using IoErrorTeller = absl::Status (*)(std::string_view action,
                                       const std::filesystem::path& path);

/// For users, who may see their own paths: "cannot ACTION PATH: why". kNotFound,
/// kPermissionDenied, kResourceExhausted (see is_disk_full) or kFailedPrecondition.
absl::Status io_error(std::string_view action, const std::filesystem::path& path);

/// Whether this value of `errno` says that there is no room: on the disk, in the user's share
/// of it, or below the limit for one file.
bool is_disk_full(int error) noexcept;

}  // namespace tet
