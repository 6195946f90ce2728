#include "core/base/posix/atomic_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <random>
#include <sys/stat.h>
#include <system_error>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/posix/folder.h"
#include "core/base/posix/io_error.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

/// The absolute path of the folder behind a symbolic link, or of the path itself, without the
/// slash that may end it.
fs::path folder_target(const std::string& path) {
  const fs::path target = link_target(path);
  return target.has_filename() ? target : target.parent_path();
}

fs::path temporary_folder_name(const fs::path& path) {
  thread_local std::mt19937_64 random{std::random_device{}()};
  return path.parent_path() /
         absl::StrCat(".tetstream.", absl::Hex(random(), absl::kZeroPad16), ".tmp");
}

/// What is at the path may be replaced: nothing, or a folder with known names in it.
absl::Status check_replaceable(const fs::path& target,
                               const std::string& path,
                               std::span<const std::string_view> known) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!fs::exists(status)) return absl::OkStatus();
  if (!fs::is_directory(status)) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot write ", path, ": it is not a folder"));
  }
  for (auto entry = fs::directory_iterator(target, error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename();
    if (std::ranges::find(known, name) != known.end()) continue;
    return absl::FailedPreconditionError(
        absl::StrCat("cannot write ", path, ": the folder holds ", name,
                     ", which is no file of this format; name a folder that is not there yet"));
  }
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("cannot write ", path, ": ", error.message()));
}

/// Some file systems cannot exchange names.
bool exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

void remove_tree(const fs::path& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

}  // namespace

absl::StatusOr<AtomicFolder> AtomicFolder::create(const std::string& path,
                                                  std::span<const std::string_view> known) {
  const fs::path target = folder_target(path);
  if (auto status = check_replaceable(target, path, known); !status.ok()) return status;
  fs::path temporary = temporary_folder_name(target);
  if (::mkdir(temporary.c_str(), 0777) != 0) return io_error("create", target);
  return AtomicFolder(target, std::move(temporary));
}

AtomicFolder::AtomicFolder(fs::path path, fs::path temporary_path)
    : path_(std::move(path)), temporary_path_(std::move(temporary_path)) {}

AtomicFolder::AtomicFolder(AtomicFolder&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_path_(std::exchange(other.temporary_path_, {})) {}

AtomicFolder::~AtomicFolder() {
  if (!temporary_path_.empty()) remove_tree(temporary_path_);
}

absl::StatusOr<AtomicFile> AtomicFolder::file(std::string_view name) const {
  return AtomicFile::create_at(temporary_path_ / name, {});
}

absl::Status AtomicFolder::take_name() {
  if (::rename(temporary_path_.c_str(), path_.c_str()) == 0) {  // nothing or an empty folder
    temporary_path_.clear();
    return absl::OkStatus();
  }
  if (errno != ENOTEMPTY && errno != EEXIST) return io_error("create", path_);
  // What is exchanged is the old folder, which the destructor removes.
  if (exchange(temporary_path_, path_)) return absl::OkStatus();
  const fs::path old = temporary_folder_name(path_);
  if (::rename(path_.c_str(), old.c_str()) != 0) return io_error("replace", path_);
  if (::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    absl::Status status = io_error("create", path_);
    ::rename(old.c_str(), path_.c_str());
    return status;
  }
  temporary_path_ = old;
  return absl::OkStatus();
}

absl::Status AtomicFolder::commit() {
  if (auto status = sync_folder(temporary_path_, io_error); !status.ok()) return status;
  if (auto status = take_name(); !status.ok()) return status;
  return sync_folder(folder_of(path_), io_error);
}

absl::Status check_can_create_folder(const std::string& path,
                                     std::span<const std::string_view> known) {
  return AtomicFolder::create(path, known).status();
}

}  // namespace tet
