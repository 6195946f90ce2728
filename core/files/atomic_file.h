// Output files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace tet {

/// A file that takes its name only when committed: until then its bytes are in a temporary file
/// of the same directory, which the destructor removes. An older file of that name stays
/// untouched until it is replaced in one step.
///
/// Errors name the path and the cause; a full disk is kResourceExhausted.
class AtomicFile {
 public:
  /// Follows a symbolic link to the file it names. Errors: kNotFound (no such directory),
  /// kPermissionDenied, kFailedPrecondition (the path is a directory or a device), ...
  static absl::StatusOr<AtomicFile> create(const std::string& path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// Writes at the current position and moves it on.
  absl::Status write(std::span<const std::byte> bytes);
  absl::Status move_to(std::uint64_t offset);

  /// Makes the file `bytes` long, and claims the disk for them where the file system can.
  absl::Status resize(std::uint64_t bytes);

  /// Everything to the disk, then to its name. The last call.
  absl::Status commit();

 private:
  AtomicFile(std::string path, std::string temporary_path, int descriptor);
  absl::Status close_descriptor();

  std::string path_, temporary_path_;
  int descriptor_ = -1;
};

/// So that the name of a file that was just made survives a power cut.
absl::Status sync_directory_of(const std::string& path);

/// Whether `path` could be created now: says so before hours of work, not after.
absl::Status check_can_create(const std::string& path);

/// A short text, whole or not at all.
absl::Status write_text_file(const std::string& path, std::string_view text);

}  // namespace tet
