#include "server/ops/file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_format.h>

#include "proto/convert/status.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

void log_disk_error(std::string_view action,
                    const std::filesystem::path& path,
                    const std::string& what) {
  nlohmann::ordered_json fields;
  fields["action"] = action;
  fields["path"] = path.string();
  fields["message"] = what;
  log_event(spdlog::level::err, "disk_error", fields);
}

}  // namespace

absl::Status disk_error(std::string_view action, const std::filesystem::path& path) {
  const int error = errno;
  const std::string what = std::generic_category().message(error);
  if (error != ENOENT) log_disk_error(action, path, what);
  const std::string message =
      absl::StrFormat("%s %s: %s", action, path.filename().string(), what);
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) {
    return with_reason(absl::ResourceExhaustedError(message), "DISK_FULL");
  }
  if (error == ENOENT) return with_reason(absl::NotFoundError(message), "DISK");
  return with_reason(absl::InternalError(message), "DISK");
}

absl::StatusOr<File> File::open(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0640);
  if (descriptor < 0) return disk_error("cannot open", path);
  return File(descriptor, path);
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}

absl::StatusOr<std::uint64_t> File::size() const {
  struct stat info {};
  if (::fstat(descriptor_, &info) != 0) return disk_error("cannot read the size of", path_);
  return static_cast<std::uint64_t>(info.st_size);
}

absl::StatusOr<mode_t> File::mode() const {
  struct stat info {};
  if (::fstat(descriptor_, &info) != 0) return disk_error("cannot read the mode of", path_);
  return info.st_mode;
}

absl::Status File::truncate(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) == 0) return absl::OkStatus();
  return disk_error("cannot truncate", path_);
}

absl::Status File::write_at(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return disk_error("cannot write to", path_);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::size_t> File::read_at(std::uint64_t offset, std::span<char> bytes) const {
  ssize_t count = -1;
  do {
    count = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  } while (count < 0 && errno == EINTR);
  if (count < 0) return disk_error("cannot read", path_);
  return static_cast<std::size_t>(count);
}

void File::begin_flush(std::uint64_t offset, std::uint64_t size) noexcept {
  ::sync_file_range(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(size),
                    SYNC_FILE_RANGE_WRITE);
}

absl::Status File::sync() {
  if (::fdatasync(descriptor_) == 0) return absl::OkStatus();
  return disk_error("cannot flush", path_);
}

absl::Status sync_folder(const std::filesystem::path& path) {
  absl::StatusOr<File> folder = File::open(path, O_RDONLY | O_DIRECTORY);
  return folder.ok() ? folder->sync() : folder.status();
}

absl::Status make_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  if (path.empty() || std::filesystem::is_directory(path, ignored)) return absl::OkStatus();
  if (absl::Status above = make_folder(path.parent_path()); !above.ok()) return above;
  if (::mkdir(path.c_str(), 0750) != 0 && errno != EEXIST) {
    return disk_error("cannot make", path);
  }
  return sync_folder(path.has_parent_path() ? path.parent_path() : ".");
}

absl::Status move_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) return disk_error("cannot move", from);
  return sync_folder(to.has_parent_path() ? to.parent_path() : ".");
}

}  // namespace tet
