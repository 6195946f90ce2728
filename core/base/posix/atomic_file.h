// Output files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/file.h"

namespace tet {

/// How a file is called until it is whole, and what else its owner decides.
struct AtomicFileStyle {
  std::string_view prefix = ".tetstream.";  ///< before 16 random digits
  std::string_view ending = ".tmp";         ///< after them
  mode_t mode = 0666;
  IoErrorTeller tell = io_error;
};

/// A file that takes its name only when committed: until then its bytes are in a temporary file
/// of the same directory, which the destructor removes. An older file of that name stays
/// untouched until it is replaced in one step.
///
/// Not thread-safe. Errors name the path and the cause; a full disk is kResourceExhausted.
class AtomicFile {
 public:
  /// For a path that a user gave: follows a symbolic link to the file it names. Errors:
  /// kNotFound (no such directory), kPermissionDenied, kFailedPrecondition (the path is a
  /// directory or a device), ...
  static absl::StatusOr<AtomicFile> create(const std::string& path);

  /// For a path in a folder of our own: looks at nothing that is there.
  static absl::StatusOr<AtomicFile> create_at(const std::filesystem::path& path,
                                              const AtomicFileStyle& style);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// Writes at the current position and moves it on.
  absl::Status write(std::span<const std::byte> bytes);
  void move_to(std::uint64_t offset) noexcept { position_ = offset; }

  /// Writes at a place of the file, wherever `write` is. Any thread may call this one.
  absl::Status write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    return file_.write_at(offset, bytes);
  }

  /// Makes the file `bytes` long, and claims the disk for them where the file system can.
  absl::Status resize(std::uint64_t bytes) { return file_.reserve(bytes); }

  /// The temporary file, for those who write it in their own way.
  File& file() noexcept { return file_; }
  const std::filesystem::path& temporary_path() const noexcept { return temporary_path_; }

  /// Everything to the disk, and no more writing: what can go wrong with the bytes has gone
  /// wrong by then, though the file has no name yet. `commit` does it unless it is done.
  absl::Status seal();

  /// Whether it was renamed, though what came after that may have failed.
  bool has_its_name() const noexcept { return temporary_path_.empty(); }

  /// What the file will be called.
  const std::filesystem::path& path() const noexcept { return path_; }

  /// Everything to the disk, then to its name, then the name to the disk. The last call.
  absl::Status commit();

  /// `commit`, except that the name may still be lost in a power cut: for many files of one
  /// folder, whose owner calls sync_folder once for all of them. The last call.
  absl::Status commit_unsynced();

 private:
  AtomicFile(std::filesystem::path path,
             std::filesystem::path temporary_path,
             File file,
             IoErrorTeller tell);

  std::filesystem::path path_, temporary_path_;  ///< temporary: empty once it is gone
  File file_;
  IoErrorTeller tell_;
  std::uint64_t position_ = 0;
  bool sealed_ = false;
};

/// The absolute path of the file behind a symbolic link, or of the path itself: what a file
/// that is created at a user's path is called.
std::filesystem::path link_target(const std::filesystem::path& path);

/// Commits two files that are of no use without each other, where readers begin with `index`:
/// at no time does an index lie beside a body that is not its own. Both are whole on the disk
/// before either has its name; then an older index gives way, the body comes, and the index.
/// After an error the older files are as they were.
absl::Status commit_together(AtomicFile& body, AtomicFile& index);

/// Whether `path` could be created now: says so before hours of work, not after.
absl::Status check_can_create(const std::string& path);

/// A short text, whole or not at all.
absl::Status write_text_file(const std::string& path, std::string_view text);

}  // namespace tet
