#include "core/files/atomic_file.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <random>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/files/io_error.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

/// Linux writes at most 2 GiB at a time; smaller pieces also let a signal handler be noticed.
constexpr std::size_t kMaxWriteBytes = std::size_t{64} << 20;

/// The absolute path of the file behind a symbolic link, or of the path itself.
std::string link_target(const std::string& path) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : target.string();
}

/// Beside `path`, and short: a name may be as long as the file system allows.
std::string temporary_name(const fs::path& path) {
  std::random_device random;
  const std::string suffix = absl::StrCat(absl::Hex(random(), absl::kZeroPad8));
  return path.parent_path() / absl::StrCat(".tetstream.", suffix, ".tmp");
}

}  // namespace

absl::Status sync_directory_of(const std::string& path) {
  const std::string directory = fs::path(path).parent_path();
  const int descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return io_error("open", directory);
  const int result = fsync(descriptor);
  // Some file systems cannot sync a directory; the file itself is safe by then.
  const bool failed = result != 0 && errno != EINVAL;
  absl::Status status = failed ? io_error("write", directory) : absl::OkStatus();
  close(descriptor);
  return status;
}

absl::StatusOr<AtomicFile> AtomicFile::create(const std::string& path) {
  std::string target = link_target(path);
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot write ", path, ": it is not a regular file"));
  }
  for (;;) {
    std::string temporary = temporary_name(target);
    const int descriptor = open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return AtomicFile(std::move(target), std::move(temporary), descriptor);
    if (errno != EEXIST) return io_error("create", path);
  }
}

AtomicFile::AtomicFile(std::string path, std::string temporary_path, int descriptor)
    : path_(std::move(path)),
      temporary_path_(std::move(temporary_path)),
      descriptor_(descriptor) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_path_(std::exchange(other.temporary_path_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!temporary_path_.empty()) unlink(temporary_path_.c_str());
}

absl::Status AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(descriptor_, bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return io_error("write", path_);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status AtomicFile::move_to(std::uint64_t offset) {
  if (lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) >= 0) return absl::OkStatus();
  return io_error("write", path_);
}

absl::Status AtomicFile::resize(std::uint64_t bytes) {
  const auto size = static_cast<off_t>(bytes);
  if (ftruncate(descriptor_, size) != 0) return io_error("write", path_);
  const bool failed = size > 0 && fallocate(descriptor_, 0, 0, size) != 0;
  return failed && errno != EOPNOTSUPP ? io_error("write", path_) : absl::OkStatus();
}

absl::Status AtomicFile::close_descriptor() {
  if (close(std::exchange(descriptor_, -1)) != 0) return io_error("write", path_);
  return absl::OkStatus();
}

absl::Status AtomicFile::commit() {
  if (fsync(descriptor_) != 0) return io_error("write", path_);
  if (absl::Status status = close_descriptor(); !status.ok()) return status;
  if (rename(temporary_path_.c_str(), path_.c_str()) != 0) return io_error("create", path_);
  temporary_path_.clear();
  return sync_directory_of(path_);
}

absl::Status check_can_create(const std::string& path) {
  return AtomicFile::create(path).status();
}

absl::Status write_text_file(const std::string& path, std::string_view text) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = file->write(std::as_bytes(std::span(text))); !status.ok()) {
    return status;
  }
  return file->commit();
}

}  // namespace tet
