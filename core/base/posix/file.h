// An open file whose failures are statuses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <span>
#include <string_view>
#include <sys/types.h>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/io_error.h"

namespace tet {

/// Among all processes that open the file.
enum class FileLock {
  kShared,        ///< with others that share it; waits until nobody has it alone
  kSharedIfFree,  ///< with others that share it; does not wait
  kAlone,         ///< does not wait
};

/// An open file. System calls that a signal interrupts or that stop halfway are carried on
/// with. Not thread-safe.
class File {
 public:
  /// `flags` are those of open(2), and `mode` is for a file that it makes. All failures of this
  /// file are told by `tell`.
  static absl::StatusOr<File> open(const std::filesystem::path& path,
                                   int flags,
                                   IoErrorTeller tell,
                                   mode_t mode = 0666);
  /// Takes over an open descriptor; `path` is what errors call it.
  File(Descriptor descriptor, std::filesystem::path path, IoErrorTeller tell)
      : descriptor_(std::move(descriptor)), path_(std::move(path)), tell_(tell) {}

  const Descriptor& descriptor() const noexcept { return descriptor_; }
  /// Leaves this one closed.
  Descriptor take_descriptor() && noexcept { return std::move(descriptor_); }

  absl::StatusOr<std::uint64_t> size() const;
  /// Its kind and permissions, as stat(2) has them.
  absl::StatusOr<mode_t> mode() const;

  /// Fills as much of `bytes` as the file has from `offset` on, and says how much.
  absl::StatusOr<std::size_t> read_at(std::uint64_t offset, std::span<char> bytes) const;
  /// Writes all of `bytes` at `offset`; on failure some of them may have been written.
  absl::Status write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  absl::Status write_at(std::uint64_t offset, std::string_view bytes) {
    return write_at(offset, std::as_bytes(std::span(bytes)));
  }
  /// Writes all of `bytes` where the last `append` ended, or at the file's end with O_APPEND.
  absl::Status append(std::string_view bytes);
  absl::Status truncate(std::uint64_t size);
  /// Makes the file `size` bytes long, and claims the disk for them where the file system can.
  absl::Status reserve(std::uint64_t size);

  /// Has the system begin to write these bytes to the disk, so that `sync` takes less time.
  /// Whether it does is `sync`'s matter.
  void begin_flush(std::uint64_t offset, std::uint64_t size) noexcept;
  /// Returns once the bytes would survive a power cut.
  absl::Status sync();
  /// The last call. The destructor closes, too, but cannot tell what went wrong.
  absl::Status close();

  /// Holds the file until it is closed or the process ends, however it does. False when
  /// somebody else has it.
  absl::StatusOr<bool> lock(FileLock how);
  /// Whether its path still leads to it: another process may have removed or replaced it.
  bool is_at_its_path() const noexcept;

 private:
  absl::Status outcome(bool good, std::string_view action) const;

  Descriptor descriptor_;
  std::filesystem::path path_;
  IoErrorTeller tell_;
};

}  // namespace tet
