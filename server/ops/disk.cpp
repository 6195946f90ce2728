#include "server/ops/disk.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <sys/statvfs.h>
#include <system_error>

#include <absl/strings/str_format.h>

#include "core/base/posix/folder.h"
#include "proto/convert/status.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr mode_t kFolderMode = 0750;

void log_disk_error(std::string_view action,
                    const std::filesystem::path& path,
                    const std::string& what) {
  nlohmann::ordered_json fields;
  fields["action"] = action;
  fields["path"] = path.string();
  fields["message"] = what;
  log_event(spdlog::level::err, "disk_error", fields);
}

/// The file system of a folder, or of the one above it.
std::optional<struct statvfs> disk_of(const std::filesystem::path& folder) {
  struct statvfs info {};
  std::filesystem::path place = folder;
  while (::statvfs(place.c_str(), &info) != 0) {
    if (errno != ENOENT || !place.has_parent_path() || place == place.parent_path()) {
      return std::nullopt;
    }
    place = place.parent_path();
  }
  return info;
}

}  // namespace

absl::Status disk_error(std::string_view action, const std::filesystem::path& path) {
  const int error = errno;
  const std::string what = std::generic_category().message(error);
  if (error != ENOENT) log_disk_error(action, path, what);
  const std::string message =
      absl::StrFormat("cannot %s %s: %s", action, path.filename().string(), what);
  if (is_disk_full(error)) {
    return with_reason(absl::ResourceExhaustedError(message), "DISK_FULL");
  }
  if (error == ENOENT) return with_reason(absl::NotFoundError(message), "DISK");
  return with_reason(absl::InternalError(message), "DISK");
}

absl::StatusOr<File> open_file(const std::filesystem::path& path, int flags) {
  return File::open(path, flags, disk_error, kFileMode);
}

absl::Status make_folder(const std::filesystem::path& path) {
  return make_folder(path, kFolderMode, disk_error);
}

absl::Status sync_folder(const std::filesystem::path& path) {
  return sync_folder(path, disk_error);
}

std::optional<std::uint64_t> free_disk_bytes(const std::filesystem::path& folder) {
  const auto disk = disk_of(folder);
  if (!disk) return std::nullopt;
  return std::uint64_t{disk->f_bavail} * disk->f_frsize;
}

std::optional<std::uint64_t> free_disk_files(const std::filesystem::path& folder) {
  constexpr std::uint64_t kKept = 1000;
  constexpr std::uint64_t kKeptPart = 16;  // of a small disk's
  const auto disk = disk_of(folder);
  if (!disk || disk->f_files == 0) return std::nullopt;
  const std::uint64_t free = disk->f_favail;
  return free - std::min(free, std::min<std::uint64_t>(kKept, disk->f_files / kKeptPart));
}

// What only root may use is no part of it.
std::optional<std::uint64_t> whole_disk_bytes(const std::filesystem::path& folder) {
  const auto disk = disk_of(folder);
  if (!disk) return std::nullopt;
  const std::uint64_t roots = disk->f_bfree - std::min(disk->f_bfree, disk->f_bavail);
  return (disk->f_blocks - std::min<std::uint64_t>(disk->f_blocks, roots)) * disk->f_frsize;
}

absl::Status no_disk_for(std::uint64_t bytes, std::uint64_t free_bytes, std::uint64_t kept) {
  return with_reason(absl::ResourceExhaustedError(absl::StrFormat(
                         "no room on the disk for %d bytes: %d are free, of which %d are kept "
                         "for the jobs' database",
                         bytes, free_bytes, kept)),
                     "DISK_FULL");
}

absl::Status move_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  return move_file(from, to, disk_error);
}

}  // namespace tet
