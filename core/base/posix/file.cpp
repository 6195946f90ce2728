#include "core/base/posix/file.h"

#include <cerrno>
#include <sys/file.h>
#include <sys/stat.h>

#include "core/base/posix/transfer.h"

namespace tet {

namespace {

int operation_of(FileLock how) {
  switch (how) {
    case FileLock::kShared:
      return LOCK_SH;
    case FileLock::kSharedIfFree:
      return LOCK_SH | LOCK_NB;
    case FileLock::kAlone:
      return LOCK_EX | LOCK_NB;
  }
  return LOCK_EX | LOCK_NB;
}

}  // namespace

absl::StatusOr<File> File::open(const std::filesystem::path& path,
                                int flags,
                                IoErrorTeller tell,
                                mode_t mode) {
  Descriptor descriptor = open_descriptor(path, flags, mode);
  if (!descriptor.is_open()) return tell("open", path);
  return File(std::move(descriptor), path, tell);
}

absl::Status File::outcome(bool good, std::string_view action) const {
  return good ? absl::OkStatus() : tell_(action, path_);
}

absl::StatusOr<std::uint64_t> File::size() const {
  struct stat facts {};
  if (::fstat(descriptor_.number(), &facts) != 0) return tell_("read the size of", path_);
  return static_cast<std::uint64_t>(facts.st_size);
}

absl::StatusOr<mode_t> File::mode() const {
  struct stat facts {};
  if (::fstat(descriptor_.number(), &facts) != 0) return tell_("read the mode of", path_);
  return facts.st_mode;
}

absl::StatusOr<std::size_t> File::read_at(std::uint64_t offset, std::span<char> bytes) const {
  const std::int64_t count =
      read_all_at(descriptor_.number(), offset, std::as_writable_bytes(bytes));
  if (count < 0) return tell_("read", path_);
  return static_cast<std::size_t>(count);
}

absl::Status File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  return outcome(write_all_at(descriptor_.number(), offset, bytes), "write to");
}

absl::Status File::append(std::string_view bytes) {
  return outcome(write_all(descriptor_.number(), std::as_bytes(std::span(bytes))), "write to");
}

absl::Status File::truncate(std::uint64_t size) {
  return outcome(::ftruncate(descriptor_.number(), static_cast<off_t>(size)) == 0, "truncate");
}

absl::Status File::reserve(std::uint64_t size) {
  if (absl::Status status = truncate(size); !status.ok() || size == 0) return status;
  const bool claimed = ::fallocate(descriptor_.number(), 0, 0, static_cast<off_t>(size)) == 0 ||
                       errno == EOPNOTSUPP;
  return outcome(claimed, "write to");
}

void File::begin_flush(std::uint64_t offset, std::uint64_t size) noexcept {
  ::sync_file_range(descriptor_.number(), static_cast<off_t>(offset), static_cast<off_t>(size),
                    SYNC_FILE_RANGE_WRITE);
}

absl::Status File::sync() { return outcome(::fdatasync(descriptor_.number()) == 0, "flush"); }

absl::Status File::close() { return outcome(descriptor_.close(), "write to"); }

absl::StatusOr<bool> File::lock(FileLock how) {
  while (::flock(descriptor_.number(), operation_of(how)) != 0) {
    if (errno == EWOULDBLOCK) return false;
    if (errno != EINTR) return tell_("lock", path_);
  }
  return true;
}

bool File::is_at_its_path() const noexcept {
  struct stat open {};
  struct stat named {};
  return ::fstat(descriptor_.number(), &open) == 0 && ::stat(path_.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

}  // namespace tet
