// The server's files: core/base/posix, with errors that clients may see.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/atomic_file.h"
#include "core/base/posix/file.h"

namespace tet {

/// The server's files may be read by their owner's group.
constexpr mode_t kFileMode = 0640;

/// The system's last error as a status: no space left (or a quota) is kResourceExhausted with
/// reason DISK_FULL; a missing file kNotFound, anything else kInternal, both with reason DISK.
/// The message is "cannot `action` file: why" with no more of `path` than the file's name,
/// since clients may see it. The whole path is logged.
absl::Status disk_error(std::string_view action, const std::filesystem::path& path);

/// `flags` as open(2) takes them.
absl::StatusOr<File> open_file(const std::filesystem::path& path, int flags);

/// Makes a directory and those above it, durably.
absl::Status make_folder(const std::filesystem::path& path);

/// Returns once the names in a directory would survive a power cut.
absl::Status sync_folder(const std::filesystem::path& path);

/// What the file system of a folder has free for this user; nothing if it cannot be told. A
/// folder that is not there yet is the one above it.
std::optional<std::uint64_t> free_disk_bytes(const std::filesystem::path& folder);

/// How many more files that file system takes, beside a few that are left for the jobs; nothing
/// if it cannot be told, or has no limit.
std::optional<std::uint64_t> free_disk_files(const std::filesystem::path& folder);

/// What that file system has for this user in all; nothing if it cannot be told.
std::optional<std::uint64_t> whole_disk_bytes(const std::filesystem::path& folder);

/// kResourceExhausted (DISK_FULL): why `bytes` cannot be stored beside what is kept free.
absl::Status no_disk_for(std::uint64_t bytes, std::uint64_t free_bytes, std::uint64_t kept);

/// Renames within one file system, atomically and durably.
absl::Status move_file(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace tet
