// Folders, and the names in them: made, moved, and safe from a power cut.
#pragma once

#include <filesystem>
#include <sys/types.h>

#include <absl/status/status.h>

#include "core/base/posix/io_error.h"

namespace tet {

/// Makes a directory and those above it that are missing, durably.
absl::Status make_folder(const std::filesystem::path& path, mode_t mode, IoErrorTeller tell);

/// Returns once the names in a directory would survive a power cut. Some file systems cannot
/// promise that of a directory, and are not asked for more.
absl::Status sync_folder(const std::filesystem::path& path, IoErrorTeller tell);

/// The directory that a path's last name is in; "." where the path does not say.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Renames within one file system, in one step, and durably.
absl::Status move_file(const std::filesystem::path& from,
                       const std::filesystem::path& to,
                       IoErrorTeller tell);

}  // namespace tet
