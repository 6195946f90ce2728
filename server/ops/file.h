// A file descriptor that closes itself, with errors that say what the disk said.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <sys/types.h>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace tet {

/// The system's last error as a status: no space left (or a quota) is kResourceExhausted with
/// reason DISK_FULL; a missing file kNotFound, anything else kInternal, both with reason DISK.
/// The message is
/// "`action` file: reason" with no more of `path` than the file's name: clients may see it. The
/// whole path is logged.
absl::Status disk_error(std::string_view action, const std::filesystem::path& path);

/// An open file. Not thread-safe.
class File {
 public:
  /// `flags` as open(2) takes them; new files may be read by their owner's group.
  static absl::StatusOr<File> open(const std::filesystem::path& path, int flags);
  ~File();
  File(File&& other) noexcept;
  File& operator=(File&&) = delete;

  absl::StatusOr<std::uint64_t> size() const;
  /// Its kind and permissions, as stat(2) has them.
  absl::StatusOr<mode_t> mode() const;
  absl::Status truncate(std::uint64_t size);
  /// Writes all of `bytes` at `offset`; on failure some of them may have been written.
  absl::Status write_at(std::uint64_t offset, std::string_view bytes);
  /// Fills as much of `bytes` as the file has from `offset` on, and says how much.
  absl::StatusOr<std::size_t> read_at(std::uint64_t offset, std::span<char> bytes) const;
  /// Has the system begin to write these bytes to the disk, so that `sync` takes less time.
  /// Whether it does is `sync`'s matter.
  void begin_flush(std::uint64_t offset, std::uint64_t size) noexcept;
  /// Returns once the bytes would survive a power cut.
  absl::Status sync();

 private:
  File(int descriptor, std::filesystem::path path)
      : descriptor_(descriptor), path_(std::move(path)) {}

  int descriptor_;
  std::filesystem::path path_;
};

/// Makes a directory and those above it, durably.
absl::Status make_folder(const std::filesystem::path& path);

/// Returns once the names in a directory would survive a power cut.
absl::Status sync_folder(const std::filesystem::path& path);

/// Renames within one file system, atomically and durably.
absl::Status move_file(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace tet
