#include "core/base/posix/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <random>
#include <system_error>
#include <unistd.h>

#include <absl/strings/str_cat.h>

#include "core/base/posix/folder.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

/// Beside `path`, and short: a name may be as long as the file system allows. No two writers,
/// on whatever host, are likely to choose the same one, a process and its copy neither: each
/// name is the system's own chance.
fs::path temporary_name(const fs::path& path, const AtomicFileStyle& style) {
  std::random_device random;
  return path.parent_path() /
         absl::StrCat(std::string(style.prefix), absl::Hex(random(), absl::kZeroPad8),
                      absl::Hex(random(), absl::kZeroPad8), std::string(style.ending));
}

/// Names that are tried, where others have taken them by chance.
constexpr int kMostNames = 10;

}  // namespace

fs::path link_target(const fs::path& path) {
  std::error_code error, not_there;
  fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  // One that leads to nothing yet is a link, too.
  constexpr int kMostLinks = 40;
  for (int links = 0; links < kMostLinks && fs::is_symlink(target, not_there); ++links) {
    target =
        fs::weakly_canonical(target.parent_path() / fs::read_symlink(target, error), error);
  }
  return error ? path : target;
}

absl::StatusOr<AtomicFile> AtomicFile::create(const std::string& path) {
  const fs::path target = link_target(path);
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot write ", path, ": it is not a regular file"));
  }
  return create_at(target, {});
}

absl::StatusOr<AtomicFile> AtomicFile::create_at(const fs::path& path,
                                                 const AtomicFileStyle& style) {
  fs::path temporary;
  Descriptor descriptor;
  for (int name = 0; name < kMostNames && !descriptor.is_open(); ++name) {
    temporary = temporary_name(path, style);
    descriptor = open_descriptor(temporary, O_RDWR | O_CREAT | O_EXCL, style.mode);
    if (!descriptor.is_open() && errno != EEXIST) break;
  }
  if (!descriptor.is_open()) return style.tell("create", path);
  // What goes wrong is told of the file that is wanted.
  File file(std::move(descriptor), path, style.tell);
  return AtomicFile(path, std::move(temporary), std::move(file), style.tell);
}

AtomicFile::AtomicFile(fs::path path, fs::path temporary_path, File file, IoErrorTeller tell)
    : path_(std::move(path)),
      temporary_path_(std::move(temporary_path)),
      file_(std::move(file)),
      tell_(tell) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_path_(std::exchange(other.temporary_path_, {})),
      file_(std::move(other.file_)),
      tell_(other.tell_),
      position_(other.position_),
      sealed_(other.sealed_) {}

AtomicFile::~AtomicFile() {
  if (!temporary_path_.empty()) ::unlink(temporary_path_.c_str());
}

absl::Status AtomicFile::write(std::span<const std::byte> bytes) {
  const absl::Status status = file_.write_at(position_, bytes);
  position_ += bytes.size();
  return status;
}

absl::Status AtomicFile::seal() {
  if (sealed_) return absl::OkStatus();
  if (absl::Status status = file_.sync(); !status.ok()) return status;
  if (absl::Status status = file_.close(); !status.ok()) return status;
  sealed_ = true;
  return absl::OkStatus();
}

absl::Status AtomicFile::commit_unsynced() {
  if (absl::Status status = seal(); !status.ok()) return status;
  if (::rename(temporary_path_.c_str(), path_.c_str()) != 0) return tell_("create", path_);
  temporary_path_.clear();
  return absl::OkStatus();
}

absl::Status AtomicFile::commit() {
  const absl::Status status = commit_unsynced();
  return status.ok() ? sync_folder(folder_of(path_), tell_) : status;
}

namespace {

/// A file out of the way until its owner says that it may go; else it comes back.
class SetAside {
 public:
  /// What is no file stays: its name cannot be had, as the one who wants it will say.
  explicit SetAside(const fs::path& path) : path_(path), aside_(temporary_name(path, {})) {
    std::error_code ignored;
    const bool is_file = fs::is_regular_file(path_, ignored);
    if (!is_file || ::rename(path_.c_str(), aside_.c_str()) != 0) aside_.clear();
  }
  ~SetAside() {
    if (!aside_.empty()) ::rename(aside_.c_str(), path_.c_str());
  }
  SetAside(const SetAside&) = delete;
  SetAside& operator=(const SetAside&) = delete;

  void drop() {
    if (!aside_.empty()) ::unlink(aside_.c_str());
    aside_.clear();
  }

 private:
  fs::path path_, aside_;
};

}  // namespace

absl::Status commit_together(AtomicFile& body, AtomicFile& index) {
  if (absl::Status status = body.seal(); !status.ok()) return status;
  if (absl::Status status = index.seal(); !status.ok()) return status;
  const fs::path body_path = body.path();
  SetAside old_index(index.path());
  SetAside old_body(body_path);
  if (absl::Status status = body.commit(); !status.ok()) return status;
  if (absl::Status status = index.commit(); !status.ok()) {
    // A body that nothing leads to is half a result, and so is an index that has its name and
    // may lose it in a power cut. Old ones take their places.
    if (index.has_its_name()) ::unlink(index.path().c_str());
    ::unlink(body_path.c_str());
    return status;
  }
  old_index.drop();
  old_body.drop();
  return absl::OkStatus();
}

absl::Status check_can_create(const std::string& path) {
  return AtomicFile::create(path).status();
}

absl::Status write_text_file(const std::string& path, std::string_view text) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = file->file().write_at(0, text); !status.ok()) return status;
  return file->commit();
}

}  // namespace tet
