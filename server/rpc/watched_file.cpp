#include "server/rpc/watched_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "server/ops/disk.h"

namespace tet {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 20;

// These messages are for the operator, who may see the path.
absl::Status refused(const std::string& path, const absl::Status& status) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", status.message()));
}

}  // namespace

absl::StatusOr<std::string> read_small_file(const std::string& path, mode_t forbidden) {
  absl::StatusOr<File> file = open_file(path, O_RDONLY);
  if (!file.ok()) return refused(path, file.status());
  const auto mode = file->mode();
  if (!mode.ok()) return refused(path, mode.status());
  if (!S_ISREG(*mode)) return absl::InvalidArgumentError(path + " is not a file");
  if ((*mode & forbidden) != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s can be read by others (mode %03o): chmod %03o %s", path,
                        *mode & 0777U, *mode & 0777U & ~forbidden, path));
  }
  const auto size = file->size();
  if (!size.ok()) return refused(path, size.status());
  if (*size > kMaxBytes) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s has %d bytes, more than %d", path, *size, kMaxBytes));
  }
  std::string text(*size, '\0');
  const auto read = file->read_at(0, text);
  if (!read.ok()) return refused(path, read.status());
  text.resize(*read);
  return text;
}

FileWatch::Stamp FileWatch::stamp_of(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return {};
  return {info.st_dev, info.st_ino, static_cast<std::uint64_t>(info.st_size),
          info.st_ctim.tv_sec, info.st_ctim.tv_nsec};
}

bool FileWatch::changed() {
  std::vector<Stamp> found;
  for (const std::string& path : paths_) found.push_back(stamp_of(path));
  if (found == stamps_) return false;
  stamps_ = std::move(found);
  return true;
}

}  // namespace tet
