// Output folders that appear whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/atomic_file.h"

namespace tet {

/// A folder that takes its name only when committed: until then its files are in a temporary
/// folder beside it, which the destructor removes. An older folder stays untouched until it is
/// replaced: in one step where the file system can exchange names, and else in two, between
/// which there is none.
///
/// Not thread-safe. Errors name the path and the cause.
class AtomicFolder {
 public:
  /// For a path that a user gave: follows a symbolic link to the folder it names. `known` are
  /// the names that a folder of this kind may hold, for what else is there is somebody's and is
  /// not replaced. Errors: kNotFound (no such directory), kPermissionDenied,
  /// kFailedPrecondition (the path is a file, or a folder with other files in it), ...
  static absl::StatusOr<AtomicFolder> create(const std::string& path,
                                             std::span<const std::string_view> known);

  AtomicFolder(AtomicFolder&& other) noexcept;
  AtomicFolder& operator=(AtomicFolder&&) = delete;
  ~AtomicFolder();

  /// A file of the folder, which its owner commits (unsynced) before the folder is.
  absl::StatusOr<AtomicFile> file(std::string_view name) const;

  /// Everything to the disk, then to its name, then the name to the disk. The last call.
  absl::Status commit();

 private:
  AtomicFolder(std::filesystem::path path, std::filesystem::path temporary_path);
  absl::Status take_name();

  std::filesystem::path path_, temporary_path_;  ///< temporary: empty once it is gone
};

/// Whether a folder could be written at `path` now.
absl::Status check_can_create_folder(const std::string& path,
                                     std::span<const std::string_view> known);

}  // namespace tet
